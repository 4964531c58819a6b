# SPDX-License-Identifier: Apache-2.0
"""Hostile and damaged files end the converter with one line and status 1, in little memory."""

import contextlib
import os
import pathlib
import pickle
import subprocess
import sys
import time
import unittest

from phystwin_test_case import Case, TwinCase, half_turn, np  # first: it finds the tools, or skips
import hostile_files
import phystwin_case_maker as maker
import phystwin_to_npz
import safe_pickle

try:
    import resource
except ImportError:  # not on Windows
    resource = None

SPARE = 160 << 20  # bytes beyond those in use before; for a million values of 100 bytes
MOST_SECONDS = 10  # a million steps of a pickle take 1 to 2 s


@contextlib.contextmanager
def little_memory(spare):
    """Lets the process take `spare` bytes more of address space, on Linux."""
    statm = pathlib.Path("/proc/self/statm")
    if resource is None or not statm.exists():
        yield
        return
    used = int(statm.read_text().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + spare, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


class HostileFileTest(TwinCase):
    def expect_harmless(self, name, data):
        path = self.folder / name
        path.write_bytes(data)
        begin = time.process_time()
        with little_memory(SPARE + 4 * len(data)):
            self.expect_refused(name)
            error = self.run_tool()[1]
        self.assertNotIn("more memory", error)  # there was enough
        self.assertTrue(error.isascii() and error[:-1].isprintable(), error)
        self.assertLess(time.process_time() - begin, 2 * MOST_SECONDS)

    def test_hostile_data(self):
        for what, data in hostile_files.pickles().items():
            with self.subTest(what):
                self.expect_harmless("final_data.pkl", data)

    def test_hostile_parameters(self):
        for what, data in hostile_files.pickles().items():
            if len(data) < 100_000:
                with self.subTest(what):
                    self.expect_harmless("optimal_params.pkl", data)

    def test_hostile_checkpoints(self):
        for what, data in hostile_files.checkpoints().items():
            with self.subTest(what):
                self.expect_harmless("best_0.pth", data)

    def test_numbers_out_of_all_bounds_are_refused(self):
        for name in ("global_spring_Y", "object_max_neighbours", "drag_damping"):
            for value in (10 ** 400, 10 ** 2000, 1e300, -1, float("inf"), "1" * 5000, (1,), b"1"):
                parameters = {**maker.PARAMETERS, name: value}
                with self.subTest(name=name, value=str(type(value))):
                    self.expect_harmless("optimal_params.pkl", pickle.dumps(parameters))

    def test_coordinates_beyond_a_kilometre_are_refused(self):
        for name in ("object_points", "controller_points", "surface_points", "interior_points"):
            data = {**self.data, name: self.data[name].astype(float) + 1001}
            self.expect_harmless("final_data.pkl", pickle.dumps(data))

    def test_what_is_no_file_is_refused(self):
        path = self.folder / "final_data.pkl"
        for target in ("/dev/zero", self.root, "nowhere"):
            path.unlink()
            path.symlink_to(target)
            with little_memory(SPARE):
                self.expect_refused("final_data.pkl")

    def test_lack_of_memory_is_one_line(self):
        large = np.zeros((6, 2_000_000, 3), np.float32)
        maker.write_pickle(self.folder / "final_data.pkl", {"object_points": large})
        with little_memory(32 << 20):
            self.expect_refused("final_data.pkl", "needs more memory than there is")

    def test_memory_is_a_few_times_the_file(self):
        data = maker.final_data(frames=60, points=20_000)
        maker.write_case(self.folder, data)
        size = (self.folder / "final_data.pkl").stat().st_size
        self.assertGreater(size, 30e6)
        with little_memory(3 * size):
            self.convert("--recording-only")

    def test_program_ends_with_1_and_one_line(self):
        (self.folder / "final_data.pkl").write_bytes(hostile_files.pickles()["memo bomb"])
        result = subprocess.run(
            [sys.executable, phystwin_to_npz.__file__, self.folder, "-o", self.output],
            capture_output=True, text=True, check=False,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"\Aphystwin_to_npz: error: .*final_data.pkl: .*\n\Z")


class RefusalTest(Case):
    def test_code_in_a_pickle_is_not_run(self):
        marker = self.root / "ran"
        maker.write_pickle(self.folder / "final_data.pkl", {"object_points": maker.Command(marker)})
        self.expect_refused("final_data.pkl", "mkdir", "refused")
        self.assertFalse(marker.exists())
        with open(self.folder / "final_data.pkl", "rb") as file:
            pickle.load(file)
        self.assertTrue(marker.exists())  # which shows that it would have run

    def test_names_that_lead_to_code_are_refused(self):
        for name in (b"builtins\neval", b"builtins\ngetattr", b"numpy\nload", b"os\nsystem",
                     b"torch\nload", b"operator\nattrgetter"):
            path = self.root / "code.pkl"
            path.write_bytes(b"c" + name + b"\n.")
            with self.assertRaisesRegex(safe_pickle.Error, "refused"):
                safe_pickle.read_pickle(path)

    def test_pickle_cut_anywhere_is_refused(self):
        maker.write_case(self.folder, maker.final_data(frames=2, points=3))
        path = self.folder / "final_data.pkl"
        whole = path.read_bytes()
        for size in range(len(whole)):
            path.write_bytes(whole[:size])
            with self.assertRaises(safe_pickle.Error):
                safe_pickle.read_pickle(path)
        path.write_bytes(whole[:-1])
        self.expect_refused("final_data.pkl", "not a whole pickle")

    def test_damaged_pickle_never_escapes(self):
        random = np.random.default_rng(3)
        maker.write_case(self.folder, maker.final_data(frames=3, points=4))
        path = self.folder / "final_data.pkl"
        whole = bytearray(path.read_bytes())
        for _ in range(150):
            damaged = bytearray(whole)
            damaged[random.integers(len(whole))] = random.integers(256)
            path.write_bytes(damaged)
            status, error = self.run_tool()
            self.assertEqual(error.count("\n"), 1 if status else error.count("note:"), error)

    def test_array_of_impossible_shape_is_refused(self):
        for shape in ((2 ** 70, 0), (1,) * 80, (-1, 3), (2, 3.0), "xy"):
            with self.assertRaisesRegex(safe_pickle.Error, "shape"):
                array = safe_pickle.Array()
                array.__setstate__((1, shape, safe_pickle._Dtype("f4"), False, b""))
                array.numpy()


class CheckpointTest(TwinCase):
    def test_checkpoint_in_the_old_format_is_refused(self):
        old = pickle.dumps(0x1950A86A20F9469CFC6C, 2) + pickle.dumps(1001, 2)
        (self.folder / "best_0.pth").write_bytes(old)
        self.expect_refused("best_0.pth", "before version 1.6")

    def test_checkpoint_cut_anywhere_is_refused(self):
        self.write_checkpoint()
        path = self.folder / "best_180.pth"
        whole = path.read_bytes()
        for size in range(0, len(whole), 97):
            path.write_bytes(whole[:size])
            self.expect_refused("best_180.pth")

    def test_code_in_a_checkpoint_is_not_run(self):
        maker.torch_save({"spring_Y": maker.Command(self.root / "ran")}, self.folder / "best_0.pth")
        self.expect_refused("best_0.pth", "refused")


class SameAsPickleTest(Case):
    def test_values_are_those_of_pickle(self):
        shared = [1, 2]
        values = [None, True, False, 0, -1, 255, 65535, 2 ** 31, -2 ** 40, 2 ** 300, 1.5, -0.0,
                  float("inf"), "", "plain", "\u00e4\u20ac\U0001f600\n\\u", (), (1,), (1, 2),
                  (1, 2, 3), (1, 2, 3, 4), [], [shared, shared], list(range(2000)), {},
                  {"a": {1: 2.5, None: []}}, {str(n): n for n in range(2000)}]
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            maker.write_pickle(self.root / "value.pkl", values, protocol)
            read = safe_pickle.read_pickle(self.root / "value.pkl")
            self.assertEqual(repr(read), repr(values))
            self.assertIs(read[22][0], read[22][1])

    def test_arrays_are_those_of_numpy(self):
        arrays = [np.arange(24, dtype=name).reshape(2, 3, 4)
                  for name in ("i1", "u2", ">i4", "<i8", "f2", ">f4", "f8")]
        arrays += [np.array([True, False]), np.array(2.5, np.float32), np.zeros((0, 3)),
                   np.asfortranarray(np.arange(12.0).reshape(3, 4)), np.arange(12)[::2]]
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            maker.write_pickle(self.root / "value.pkl", arrays, protocol)
            for read, array in zip(safe_pickle.read_pickle(self.root / "value.pkl"), arrays):
                np.testing.assert_array_equal(read.numpy(), array)
                self.assertEqual(read.numpy().dtype, array.dtype)

    def test_torch_checkpoint_is_read_whole(self):
        values = half_turn(np.arange(12.0).reshape(4, 3))
        maker.torch_save({"a": maker.Tensor(values), "b": maker.Tensor(7.0)}, self.root / "a.pth")
        read = safe_pickle.read_torch(self.root / "a.pth")
        np.testing.assert_array_equal(read["a"].numpy(), values)
        self.assertEqual(read["b"].numpy(), 7)


if __name__ == "__main__":
    unittest.main()
