# SPDX-License-Identifier: Apache-2.0
"""What the tests of the PhysTwin tools share: a folder with a case, and the converter run on it."""

import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

try:
    import numpy as np
except ImportError:
    print("skipped: needs numpy (apt-get install python3-numpy)")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "tools"), str(HERE)]
import phystwin_case_maker as maker  # noqa: E402
import phystwin_springs  # noqa: E402
import phystwin_to_npz  # noqa: E402


def half_turn(points):
    """PhysTwin's frame (z down) to ours (z up)."""
    return np.asarray(points) @ np.diag([1.0, -1.0, -1.0])


class Case(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = pathlib.Path(temporary.name)
        self.folder = self.root / "data" / "different_types" / "rope"
        self.output = self.root / "rope.npz"
        self.data = maker.final_data()

    def run_tool(self, *options, folder=None):
        """(exit status, what it wrote to stderr)"""
        error = io.StringIO()
        with contextlib.redirect_stderr(error), contextlib.redirect_stdout(io.StringIO()):
            status = phystwin_to_npz.main(
                [str(folder or self.folder), "-o", str(self.output), *map(str, options)])
        return status, error.getvalue()

    def convert(self, *options, folder=None):
        status, error = self.run_tool(*options, folder=folder)
        self.assertEqual(status, 0, error)
        with np.load(self.output) as recording:
            return dict(recording)

    def convert_twin(self, *options, folder=None):
        self.convert(*options, folder=folder)
        with np.load(self.root / "rope.twin.npz") as twin:
            return dict(twin)

    def expect_refused(self, *words, options=()):
        before = sorted(self.root.rglob("*"))
        status, error = self.run_tool(*options)
        self.assertEqual(status, 1)
        self.assertEqual(error.count("\n"), 1, error)
        for word in words:
            self.assertIn(word, error)
        self.assertEqual(sorted(self.root.rglob("*")), before)

    def particles(self):
        return np.concatenate([self.data["object_points"][0], self.data["surface_points"],
                               self.data["interior_points"]]).astype(np.float32)


class TwinCase(Case):
    """A case that has parameters."""

    def setUp(self):
        super().setUp()
        maker.write_case(self.folder, self.data)
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)

    def write_checkpoint(self, path=None, change=0):
        springs, _, object_springs = phystwin_springs.find_springs(
            self.particles(), self.data["controller_points"][0].astype(np.float32),
            maker.PARAMETERS)
        spring_Y = np.random.default_rng(2).uniform(1e4, 9e4, len(springs) + change)
        spring_Y[:2] = 2e5, 0
        maker.torch_save(maker.checkpoint(spring_Y, object_springs),
                         path or self.folder / "best_180.pth")
        return spring_Y.astype(np.float32)
