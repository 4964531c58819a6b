# SPDX-License-Identifier: Apache-2.0
"""What the tests of the importers of cables share: a folder of a cable, and the tool run on it."""

import pathlib
import pickle
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy  # noqa: F401
except ImportError:
    print("SKIPPED: NumPy is not installed")
    sys.exit(77)

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


class CableCase(unittest.TestCase):
    TOOL, CABLE = "", ""  # names of the tool and of the cable

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        self.cable, self.output = self.root / self.CABLE, self.root / "out"

    def write(self, name, value):
        path = self.cable / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(pickle.dumps(value))

    def run_tool(self, *flags):
        return subprocess.run([sys.executable, TOOLS / self.TOOL, self.cable, "-o", self.output, *flags],
                              capture_output=True, text=True)
