# SPDX-License-Identifier: Apache-2.0
"""`physpring track --stream` answers each frame before it reads the next one.

    track_stream_test.py PROGRAM MAKE_SMALL_TWIN

PROGRAM is the built `physpring`, MAKE_SMALL_TWIN writes the twin of a block of 40 particles, 32 of
them points, held by 2 controllers.
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

MAKE_SMALL_TWIN, PROGRAM = sys.argv.pop(2), sys.argv.pop(1)


def reference(twin):
    """The columns of level 0's reference configuration, as a list of [x, y, z]."""
    with zipfile.ZipFile(twin) as arrays:
        data = arrays.read("level0/position.npy")
    start = 10 + struct.unpack("<H", data[8:10])[0]
    header = data[10:start].decode()
    values = struct.unpack(f"<{(len(data) - start) // 8}d", data[start:])
    count = len(values) // 3
    if "'fortran_order': True" in header:
        return [[values[i], values[count + i], values[2 * count + i]] for i in range(count)]
    return [list(values[3 * i : 3 * i + 3]) for i in range(count)]


class Stream(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        subprocess.run([MAKE_SMALL_TWIN, self.folder.name], check=True)
        self.twin = next(pathlib.Path(self.folder.name).glob("*.twin.npz"))
        columns = reference(self.twin)
        self.points, self.controllers = columns[:32], columns[-2:]

    def run_stream(self, *options):
        return subprocess.Popen(
            [PROGRAM, "track", str(self.twin), "--stream", *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def frame(self, step):
        """The block pushed along y, every other point of it not seen."""
        seen = [[x, y + 0.002 * step, z] for x, y, z in self.points]
        return {
            "points": [p if (i + step) % 2 else None for i, p in enumerate(seen)],
            "controllers": [[x, y + 0.002 * step, z] for x, y, z in self.controllers],
        }

    def test_answers_each_frame(self):
        with self.run_stream("--fps", "50") as program:
            for step in range(8):
                program.stdin.write(json.dumps(self.frame(step)) + "\n")
                program.stdin.flush()
                state = json.loads(program.stdout.readline())
                self.assertEqual(state["frame"], step)
                self.assertEqual(len(state["position"]), 40)
                self.assertEqual(len(state["velocity"]), 40)
            for (x, y, z), place in zip(self.points, state["position"]):
                self.assertLess(abs(place[1] - y - 0.014), 2e-3)
            self.assertEqual(program.communicate()[1], "")
        self.assertEqual(program.returncode, 0)

    def test_hands_let_go_and_take_hold(self):
        with self.run_stream("--fps", "50") as program:
            for step in range(12):
                frame = self.frame(0)
                if step == 4:
                    frame["held"] = [True, False]
                if 4 <= step < 8:
                    frame["controllers"][1] = None
                if step == 8:
                    frame["held"] = [True, True]
                program.stdin.write(json.dumps(frame) + "\n")
                program.stdin.flush()
                state = json.loads(program.stdout.readline())
            for seen, place in zip(self.points, state["position"]):
                for a, b in zip(seen, place):
                    self.assertLess(abs(a - b), 2e-3)
            self.assertEqual(program.communicate()[1], "")
        self.assertEqual(program.returncode, 0)

    def test_warns_of_a_body_that_is_hardly_the_twin(self):
        with self.run_stream("--substeps", "1") as program:
            errors = program.communicate(json.dumps(self.frame(0)) + "\n")[1]
        self.assertIn("% of the springs: the body may be lost", errors)
        self.assertEqual(program.returncode, 0)

    def refused(self, *lines):
        with self.run_stream() as program:
            errors = program.communicate("".join(line + "\n" for line in lines))[1]
        self.assertEqual(program.returncode, 1)
        self.assertEqual(errors.count("\n"), 1, errors)
        return errors

    def test_refuses_what_is_no_frame(self):
        first = json.dumps(self.frame(0))
        self.assertIn("line 1 of the input: is not an object of JSON", self.refused("points"))
        far = json.dumps({**self.frame(0), "points": [[1e300, 0, 0]] * 32})
        self.assertIn("line 2 of the input: 'points' [0] is 1e+300 m away", self.refused(first, far))
        self.assertIn("line 1 of the input: is longer than 4 MiB", self.refused("a" * (5 << 20)))
        self.assertIn("line 2 of the input: 'colour' is not", self.refused(first, '{"colour": 1}'))
        self.assertIn("line 1 of the input: has 0 controllers, expected 2", self.refused("{}"))
        bad = json.dumps({**self.frame(0), "points": [[0, 0]]})
        self.assertIn("line 2 of the input: 'points' [0] is not [x, y, z]", self.refused(first, bad))
        words = json.dumps({**self.frame(0), "held": [1, 0]})
        self.assertIn("'held' is not a list of true and false", self.refused(words))
        more = json.dumps({**self.frame(0), "held": [True]})
        self.assertIn("says of 1 controllers whether they hold, expected 2", self.refused(more))
        nowhere = json.dumps({**self.frame(0), "controllers": [None, self.controllers[1]]})
        self.assertIn("does not say where controller 0 is, which holds", self.refused(nowhere))
        few = json.dumps({**self.frame(0), "points": [[0, 0, 0]]})
        self.assertIn("line 2 of the input: has 1 points, expected 32", self.refused(first, few))


if __name__ == "__main__":
    unittest.main()
