# SPDX-License-Identifier: Apache-2.0
"""Splats to try with lie on their twin: checkered_splats_test.py PHYSPRING PROJECT"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy  # noqa: F401
except ImportError:
    print('SKIPPED: NumPy is not installed')
    sys.exit(77)

PHYSPRING, PROJECT = sys.argv[1], pathlib.Path(sys.argv[2])
TOOL = PROJECT / 'tools/checkered_splats.py'
TWIN = PROJECT / 'models/scenes/toy_packing/toy.twin.npz'


class CheckeredSplatsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.splats = pathlib.Path(folder.name) / 'toy.ply'

    def test_they_lie_on_their_twin(self):
        subprocess.run([sys.executable, TOOL, TWIN, self.splats, '--count', '500'], check=True)
        done = subprocess.run([PHYSPRING, 'splats', TWIN, self.splats], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, '')  # no warning of another place or scale
        self.assertIn('500 splats', done.stdout)

    def test_other_files_are_one_line(self):
        done = subprocess.run([sys.executable, TOOL, TOOL, self.splats], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn('is no twin', done.stderr.splitlines()[-1])
        self.assertFalse(self.splats.exists())


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
