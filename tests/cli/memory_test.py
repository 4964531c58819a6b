# SPDX-License-Identifier: Apache-2.0
"""Files that would take much memory are refused before they do, and large ones take little.

    memory_test.py PROGRAM

PROGRAM is the built `physpring`. It runs under a limit of its address space (as by `ulimit -v`), so
that memory that is taken and not used counts, too.
"""

import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

PROGRAM = sys.argv.pop(1)
MIB = 1 << 20
# What the program takes before it reads anything: 8 MiB of stack for each thread, and libraries.
OWN = 160 * MIB


def npy(kind, shape, values):
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + values


def points_at_rest(frames, points):
    """A (frames, points, 3) array of float32."""
    places = [x for i in range(points) for x in (i * 1e-3, i % 5 * 1e-3, i % 7 * 1e-3)]
    frame = struct.pack(f"<{len(places)}f", *places)
    return npy("<f4", (frames, points, 3), frame * frames)


class Memory(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.file = pathlib.Path(self.folder.name) / "made.npz"

    def write(self, points, packing=zipfile.ZIP_DEFLATED, frames=2):
        with zipfile.ZipFile(self.file, "w", packing) as archive:
            archive.writestr("points.npy", points)
            archive.writestr("controllers.npy", npy("<f4", (frames, 0, 3), b""))
            archive.writestr("fps.npy", npy("<f8", (), struct.pack("<d", 30)))

    def info(self, limit):
        """Runs `physpring info FILE` within `limit` bytes besides the program's own."""
        def set_limit():
            resource.setrlimit(resource.RLIMIT_AS, (OWN + limit, OWN + limit))
        return subprocess.run([PROGRAM, "info", str(self.file)], preexec_fn=set_limit,
                              capture_output=True, text=True, check=False)

    def expect_refused(self, limit, message):
        result = self.info(limit)
        self.assertEqual(result.returncode, 1, result)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(f"{self.file}: {message}", result.stderr)

    def test_the_limit_is_one(self):
        # 64 MiB of float32 are 128 MiB of doubles
        self.write(points_at_rest(1400, 4000), zipfile.ZIP_STORED, 1400)
        self.assertNotEqual(self.info(100 * MIB).returncode, 0)

    def test_many_frames_of_nothing(self):
        self.write(npy("<f4", (1 << 26, 0, 3), b""))
        self.assertLess(self.file.stat().st_size, 600)
        self.expect_refused(MIB, "array 'points' has no points, expected at least one")

    def test_an_extent_beyond_memory(self):
        for shape in ((1 << 40, 0, 3), (1 << 40, 1 << 40, 0), (0, 1 << 31, 3)):
            self.write(npy("<f4", shape, b""))
            self.expect_refused(MIB, "array 'points' has a shape with the extent "
                                     f"{max(shape)}, expected up to 32 extents below 2^31")

    def test_packed_bytes_count_as_doubles(self):
        values = 192 * MIB
        self.write(npy("|u1", (2, values // 6, 3), bytes(values)))
        self.assertLess(self.file.stat().st_size, 200_000)
        self.expect_refused(16 * MIB, f"array 'points' has {values} values, more than are read of "
                                      "a file of this size")

    def test_the_largest_small_file(self):
        values = 32 * MIB // 6 * 6
        self.write(npy("|u1", (2, values // 6, 3), bytes(values)))
        # besides the bytes: two frames as doubles, and three times as much as one for what each
        # particle has
        limit = values + values * 8 + 3 * values * 4 + 100 * MIB
        self.expect_refused(limit, "array 'points' has point ")

    def test_many_frames_of_one_point(self):
        frames = (1 << 22) + 1
        self.write(npy("|u1", (frames, 1, 3), bytes(3 * frames)), frames=frames)
        self.expect_refused(128 * MIB, f"array 'points' has {frames} frames, expected at most")

    def test_a_large_recording_takes_three_times_its_size(self):
        frames, points = 1400, 4000
        for packing in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            values = points_at_rest(frames, points)
            self.write(values, packing, frames)
            result = self.info(3 * len(values))
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"points       {points},", result.stdout)


if __name__ == "__main__":
    unittest.main()
