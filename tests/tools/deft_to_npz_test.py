# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/deft_to_npz.py. PHYSPRING, where set, is the program that reads its output."""

import json
import os
import subprocess
import unittest

from cable_case import CableCase

import numpy as np

FRAMES, MARKERS = 500, 16
GAP = 0.07  # m


def markers(t):
    """BDLO4: a straight branch of 12 along x that rises, one of 2 upwards from marker 4 and one from
    marker 8; (16, 3), z up."""
    main = [[i * GAP, 0, 0] for i in range(12)]
    up, other = ([[i * GAP, 0, GAP * n] for n in (1, 2)] for i in (4, 8))
    return np.array(main + up + other) + [0, 0, 0.2 * t]


def file_of(frames):
    """x, y, z of all frames as DEFT has them: y up, (x, y, z) here is (-z, -x, y) there."""
    x, y, z = np.moveaxis(frames, -1, 0)
    return [tuple(list(axis.ravel()) for axis in (-y, z, -x))]


class DeftTest(CableCase):
    TOOL, CABLE = "deft_to_npz.py", "BDLO4"

    def setUp(self):
        super().setUp()
        self.frames = np.stack([markers(t / 100) for t in range(FRAMES)])
        for name in ("train/hand_block1_frames100to599.pkl", "train/arm_block1_frames7to506.pkl",
                     "eval/hand_block2_frames700to1199.pkl"):
            self.write(name, file_of(self.frames))

    def test_markers_become_points_and_controllers(self):
        done = self.run_tool("--mass", "0.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        file = np.load(self.output / "hand_block1_frames100to599.npz")
        held, free = [0, 1, 10, 11], [*range(2, 10), *range(12, 16)]
        np.testing.assert_allclose(file["points"], self.frames[1:, free], atol=1e-6)
        np.testing.assert_allclose(file["controllers"], self.frames[1:, held], atol=1e-6)
        # 9 gaps of the main branch that are not held, 2 of each other one
        self.assertEqual(len(file["interior"]), 3 * (9 + 2 + 2))
        np.testing.assert_allclose(file["velocity"], np.tile([0, 0, 0.2], (12 + 39, 1)), atol=1e-4)
        # nothing deforms here, so the shape is that of all frames, moved
        together = np.concatenate([file["points"][0], file["interior"], file["controllers"][0]])
        shift = together - file["rest"][:, [0, 2, 1]]
        np.testing.assert_allclose(shift, np.tile(shift[0], (len(shift), 1)), atol=1e-5)
        self.assertEqual((float(file["fps"]), float(file["mass"])), (100, 0.1))

    def test_particles_are_along_the_branches(self):
        self.run_tool("--between", "1")
        interior = np.load(self.output / "hand_block1_frames100to599.npz")["interior"] - [0, 0, 0.002]
        main = [[(i + 0.5) * GAP, 0, 0] for i in range(1, 10)]
        up, other = ([[i * GAP, 0, GAP * n] for n in (0.5, 1.5)] for i in (4, 8))
        np.testing.assert_allclose(interior, main + up + other, atol=1e-5)

    def test_the_data_set_has_roles_and_takes(self):
        self.run_tool()
        dataset = json.loads((self.output / "dataset.json").read_text())
        self.assertEqual([(one["file"], one["role"], one["continuous_recording"])
                          for one in dataset["recordings"]],
                         [("arm_block1_frames7to506.npz", "fit", 0),
                          ("hand_block1_frames100to599.npz", "fit", 1),
                          ("hand_block2_frames700to1199.npz", "heldout", 1)])

    def test_edges_follow_the_branches(self):
        self.run_tool("--between", "1")
        file = np.load(self.output / "hand_block1_frames100to599.npz")
        where = np.concatenate([file["points"][0], file["interior"], file["controllers"][0]])
        edges = file["rod"]
        length = np.linalg.norm(where[edges[:, 0]] - where[edges[:, 1]], axis=1)
        # 9 gaps and 4 with a particle between, 2 of held markers without
        np.testing.assert_allclose(np.sort(length), [GAP / 2] * 26 + [GAP] * 2, atol=1e-5)
        degree = np.bincount(edges.ravel())
        self.assertEqual(sorted(degree), [1] * 4 + [2] * 23 + [3] * 2)
        np.testing.assert_allclose(where[degree == 3, 0], [4 * GAP, 8 * GAP], atol=1e-5)

    @unittest.skipUnless("PHYSPRING" in os.environ, "no program")
    def test_the_program_reads_them(self):
        self.run_tool("--mass", "0.1")
        done = subprocess.run([os.environ["PHYSPRING"], "info",
                               self.output / "arm_block1_frames7to506.npz"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("controllers  4", done.stdout)
        self.assertIn("rod          1.050 m long in all, 2 joints", done.stdout)

    def test_bad_files_are_one_line_and_nothing_is_written(self):
        bad = {"is no list of x, y and z": [[1, 2], [3]],
               "(3, 8000) is expected": file_of(self.frames[:, :-1]),
               "not finite": file_of(self.frames * np.nan)}
        for message, value in bad.items():
            with self.subTest(message):
                self.write("train/hand_block1_frames100to599.pkl", value)
                done = self.run_tool()
                self.assertEqual(done.returncode, 1)
                self.assertIn(message, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1)
                self.assertFalse(self.output.exists())

    def test_a_cable_of_another_name_is_refused(self):
        other = self.root / "cable"
        self.cable.rename(other)
        self.cable = other
        self.assertIn("is none of BDLO1", self.run_tool().stderr)


if __name__ == "__main__":
    unittest.main()
