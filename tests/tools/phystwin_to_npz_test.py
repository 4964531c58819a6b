# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_to_npz.py. PHYSPRING, where set, is the program that reads its output."""

import contextlib
import io
import json
import os
import subprocess
import unittest

from phystwin_test_case import Case, TwinCase, np  # first: it finds the tools, or skips
import phystwin_case_maker as maker
import phystwin_to_npz


class ResultsTest(TwinCase):
    def test_results_are_found_where_phystwin_keeps_them(self):
        (self.folder / "optimal_params.pkl").unlink()
        results = self.root / "experiments_optimization" / "rope" / "optimal_params.pkl"
        maker.write_pickle(results, maker.PARAMETERS)
        experiment = self.root / "experiments" / "rope"
        spring_Y = self.write_checkpoint(experiment / "train" / "best_0.pth")
        twin = self.convert_twin("--mass", 61)  # 1 kg a particle
        np.testing.assert_allclose(twin["level0/stiffness"] * twin["level0/rest_length"],
                                   np.clip(spring_Y, 0, 1e5))

    def test_recording_only_writes_no_twin(self):
        self.convert("--recording-only")
        self.assertFalse((self.root / "rope.twin.npz").exists())

    def test_two_checkpoints_are_refused(self):
        self.write_checkpoint()
        self.write_checkpoint(self.folder / "best_20.pth")
        self.expect_refused("2 files best_*.pth", "--checkpoint")

    def test_checkpoint_without_parameters_is_refused(self):
        self.write_checkpoint()
        (self.folder / "optimal_params.pkl").unlink()
        self.expect_refused("best_180.pth", "optimal_params.pkl")


class OutputTest(TwinCase):
    def test_hash_is_fnv_1a(self):
        # http://www.isthe.com/chongo/tech/comp/fnv: vectors of FNV-1a, 64 bits
        self.assertEqual(phystwin_to_npz.hash_bytes(b""), "cbf29ce484222325")
        self.assertEqual(phystwin_to_npz.hash_bytes(b"foobar"), "85944171f73967e8")

    def test_meta_names_the_recording_by_its_hash(self):
        meta = json.loads(self.convert_twin()["meta"].tobytes())
        self.assertEqual((meta["points"], meta["interior"], meta["controllers"]), (40, 21, 3))
        self.assertFalse(meta["controller_velocity"])
        file_hash = phystwin_to_npz.hash_bytes(self.output.read_bytes())
        self.assertEqual(meta["recordings"],
                         [{"name": "rope", "hash": file_hash, "train_frames": 4}])

    @unittest.skipUnless("PHYSPRING" in os.environ, "PHYSPRING names no program")
    def test_physpring_takes_the_twin_as_trained_on_the_recording(self):
        springs = len(self.write_checkpoint())
        self.convert("--mass", 0.1)
        result = subprocess.run(
            [os.environ["PHYSPRING"], "eval", "rope.twin.npz", "rope.npz", "--json", "eval.json"],
            cwd=self.root, capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        level = json.loads((self.root / "eval.json").read_text())["levels"][0]
        self.assertEqual((level["nodes"], level["springs"], level["substeps"]), (61, springs, 667))
        self.assertIsNotNone(level["fit"])


class ToolTest(Case):
    def test_missing_case_is_refused(self):
        self.expect_refused("no such folder")
        self.folder.mkdir(parents=True)
        self.expect_refused("final_data.pkl", "No such file")

    def test_failed_write_leaves_what_was_there(self):
        maker.write_case(self.folder, self.data)
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)
        self.output.write_text("old")
        (self.root / "rope.twin.npz").mkdir()
        self.expect_refused("rope.twin.npz", "folder")
        self.assertEqual(self.output.read_text(), "old")
        self.output = self.root / "nowhere" / "rope.npz"
        self.expect_refused("nowhere", "No such file")

    def test_wrong_usage_ends_with_2(self):
        for options in (["--mass", "-1"], ["-o", "rope.twin.npz"], ["--unknown"]):
            with self.assertRaises(SystemExit) as end, contextlib.redirect_stderr(io.StringIO()):
                phystwin_to_npz.main(["case", "-o", str(self.output), *options])
            self.assertEqual(end.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
