# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/deform_to_npz.py. PHYSPRING, where set, is the program that reads its output."""

import json
import os
import pickle
import subprocess
import unittest

from cable_case import CableCase

import numpy as np

MARKERS, FRAMES = 7, 12


def quarter_circle(t):
    """Markers on a quarter of a circle of 0.4 m that rises: (3, markers)."""
    angle = np.linspace(0, np.pi / 2, MARKERS)
    return np.stack([0.4 * np.cos(angle), 0.4 * np.sin(angle), np.full(MARKERS, 0.5 + 0.3 * t)])


class DeformTest(CableCase):
    TOOL, CABLE = "deform_to_npz.py", "DLO9"

    def setUp(self):
        super().setUp()
        # 10 goes on where 9 ended, 11 is elsewhere
        self.write("train/9.pkl", range(0, FRAMES))
        self.write("eval/10.pkl", range(FRAMES, 2 * FRAMES))
        self.write("train/11.pkl", range(1000, 1000 + FRAMES))

    def write(self, name, times, change=lambda frames: frames):
        frames = [quarter_circle(t / 100).tolist() for t in times]  # lists, as DEFORM's
        super().write(name, change(frames))

    def test_markers_become_points_and_controllers(self):
        done = self.run_tool("--mass", "0.1")
        self.assertEqual(done.returncode, 0, done.stderr)
        file = np.load(self.output / "009.npz")
        first = quarter_circle(0.01).T  # frame 0 is the second of the file
        np.testing.assert_allclose(file["points"][0], first[2:-2], atol=1e-6)
        np.testing.assert_allclose(file["controllers"][0], first[[0, 1, -2, -1]], atol=1e-6)
        self.assertEqual(len(file["points"]), FRAMES - 1)
        np.testing.assert_allclose(file["velocity"], np.tile([0, 0, 0.3], (3 + 12, 1)), atol=1e-4)
        self.assertEqual((float(file["fps"]), float(file["mass"])), (100, 0.1))

    def test_particles_between_are_on_the_line(self):
        self.run_tool("--between", "5")
        file = np.load(self.output / "009.npz")
        self.assertEqual(len(file["interior"]), 4 * 5)  # gaps between markers 1 to 5
        radius = np.hypot(*file["interior"][:, :2].T)
        self.assertLess(np.abs(radius - 0.4).max(), 1e-3)  # a straight line would be 3.4 mm inside
        order = file["order"]
        self.assertEqual(len(np.unique(order)), MARKERS + 20)
        self.assertAlmostEqual(float(order.max()), 0.4 * np.pi / 2, delta=1e-3)
        together = np.concatenate([file["points"][0], file["interior"], file["controllers"][0]])
        angles = np.arctan2(together[:, 1], together[:, 0])
        np.testing.assert_array_equal(np.argsort(order), np.argsort(angles))
        np.testing.assert_allclose(order, 0.4 * angles, atol=2e-3)

    def test_the_data_set_has_roles_and_what_is_continuous(self):
        self.run_tool()
        dataset = json.loads((self.output / "dataset.json").read_text())
        self.assertEqual([(one["file"], one["role"], one["continuous_recording"])
                          for one in dataset["recordings"]],
                         [("009.npz", "fit", 0), ("010.npz", "heldout", 0), ("011.npz", "fit", 1)])

    @unittest.skipUnless("PHYSPRING" in os.environ, "no program")
    def test_the_program_reads_them(self):
        self.run_tool("--mass", "0.1")
        done = subprocess.run([os.environ["PHYSPRING"], "info", self.output / "010.npz"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("rod", done.stdout)
        self.assertIn("controllers  4", done.stdout)

    def test_bad_files_are_one_line_and_nothing_is_written(self):
        bad = {"is no list of frames": lambda frames: frames[:-1] + [[1, 2]],
               "has shape (12, 3, 4)": lambda frames: np.array(frames)[:, :, :4].tolist(),
               "not finite": lambda frames: (np.array(frames) * np.nan).tolist()}
        for message, change in bad.items():
            with self.subTest(message):
                self.write("train/9.pkl", range(FRAMES), change)
                done = self.run_tool()
                self.assertEqual(done.returncode, 1)
                self.assertIn(message, done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1)
                self.assertFalse(self.output.exists())
        (self.cable / "train/9.pkl").write_bytes(pickle.dumps(print))
        self.assertIn("9.pkl", self.run_tool().stderr)

    def test_what_is_there_stays(self):
        self.run_tool()
        done = self.run_tool()
        self.assertEqual(done.returncode, 1)
        self.assertIn("has a dataset.json already", done.stderr)


if __name__ == "__main__":
    unittest.main()
