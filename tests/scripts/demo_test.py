# SPDX-License-Identifier: Apache-2.0
"""Tests of scripts/demo and of the table it ends with, on small made-up reports.

    demo_test.py PROGRAM ROOT

PROGRAM is the built `physpring`, ROOT the source folder. The demo itself takes minutes and is not
run: its commands are checked against the program's help.
"""

import contextlib
import io
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

PROGRAM, ROOT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "tests/docs")]
sys.dont_write_bytecode = True
import check_docs  # noqa: E402
import demo_table  # noqa: E402


def recording(name, trained_on, levels, motionless):
    """Of levels, (nodes, springs, lifted error in m, frames a second) each."""
    return {"file": f"results/{name}", "trained_on": trained_on,
            "levels": [{"level": i, "nodes": nodes, "springs": springs, "fps": fps,
                        "prediction": {"track": 99.0, "track_lifted": error}}
                       for i, (nodes, springs, error, fps) in enumerate(levels)],
            "motionless": {"prediction": {"track": motionless}}}


def effect(name, parameters, standard_errors):
    return {"name": name, "parameters": parameters, "standard_errors": standard_errors}


class TableTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        levels = [(100, 1000, 0.0123, 3000.0), (60, 480, 0.0145, 9000.0)]
        self.errors = {"recordings": [recording("a.npz", True, [(1, 2, 0.5, 30.0)] * 2, 0.6),
                                      recording("b.npz", False, levels, 0.2)]}
        self.report = {"noise_floor": 0.0016,
                       "before": {"fit": 0.5, "heldout": 0.0246},
                       "after": {"fit": 0.5, "heldout": 0.0017},
                       "effects": [effect("late", {"by_s": 0.1}, {"by_s": 0.01})]}

    def run_table(self, *truth, unseen="b.npz"):
        """(exit status, rows as lists of words, what it wrote to stderr)"""
        paths = {}
        for name, report in (("errors", self.errors), ("diagnosis", self.report)):
            paths[name] = self.folder / f"{name}.json"
            if report is not None:
                paths[name].write_text(json.dumps(report), encoding="utf-8")
        arguments = [f"--{name}={path}" for name, path in paths.items()]
        arguments += ["--unseen", unseen, "--fps", "30"]
        for one in truth:
            arguments += ["--truth", one]
        out, error = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            status = demo_table.main(arguments)
        return status, [line.split() for line in out.getvalue().splitlines()], error.getvalue()

    def rows(self, *truth):
        status, rows, error = self.run_table(*truth)
        self.assertEqual((status, error), (0, ""))
        return rows

    def test_levels_are_those_of_the_unseen_recording(self):
        rows = self.rows()
        self.assertIn("level 0 100 1000 12.30 mm 100 x real time".split(), rows)
        self.assertIn("level 1 60 480 14.50 mm 300 x real time".split(), rows)
        self.assertIn("if nothing moved 200.00 mm".split(), rows)

    def test_found_effect_stands_beside_the_truth(self):
        # half an interval: 1.96 * 0.01
        self.assertIn("late.by_s 0.12 0.1 0.0804 to 0.1196 24.60 mm 1.70 mm".split(),
                      self.rows("late.by_s=0.12"))

    def test_effect_that_was_not_found_is_told(self):
        self.report["effects"] = []
        self.assertIn("late.by_s 0.12 not found 24.60 mm 1.70 mm".split(),
                      self.rows("late.by_s=0.12"))

    def test_wrongly_named_effect_is_told(self):
        rows = self.rows("wind.speed=3")
        self.assertIn("wind.speed 3 not found 24.60 mm 1.70 mm".split(), rows)
        self.assertIn("late.by_s not there 0.1 0.0804 to 0.1196".split(), rows)

    def test_each_value_of_a_list_has_a_row(self):
        self.report["effects"] = [effect("force", {"x_n": [1.0, 2.0]}, {"x_n": [0.0, 0.5]})]
        rows = self.rows()
        self.assertIn("force.x_n[0] not there 1 1 to 1 24.60 mm 1.70 mm".split(), rows)
        self.assertIn("force.x_n[1] not there 2 1.02 to 2.98".split(), rows)

    def test_error_without_data_is_told(self):
        self.errors["recordings"][1]["levels"][0]["prediction"]["track_lifted"] = None
        self.assertIn("level 0 100 1000 no data 100 x real time".split(), self.rows())

    def test_refuses_a_recording_that_training_has_seen(self):
        status, rows, error = self.run_table(unseen="a.npz")
        self.assertEqual((status, rows), (1, []))
        self.assertIn("no recording a.npz that training has not seen", error)

    def test_refuses_a_report_that_is_not_there(self):
        self.report = None
        status, rows, error = self.run_table()
        self.assertEqual((status, rows), (1, []))
        self.assertIn("diagnosis.json", error)

    def test_refuses_a_report_of_another_kind(self):
        del self.report["noise_floor"]
        status, _, error = self.run_table()
        self.assertEqual((status, error), (1, "demo_table.py: a report has no 'noise_floor'\n"))


class DemoTest(unittest.TestCase):
    def demo(self, flag):
        return subprocess.run([ROOT / "scripts/demo", flag], capture_output=True, text=True,
                              check=True).stdout

    def test_help_says_what_it_does(self):
        self.assertTrue(self.demo("--help").startswith("usage: scripts/demo"))

    def test_commands_are_those_of_the_program(self):
        program_help = check_docs.Help(PROGRAM)
        commands = [shlex.split(line)[2:] for line in self.demo("--dry-run").splitlines()
                    if line.startswith("$ build/release/physpring ")]
        self.assertEqual([words[0] for words in commands],
                         ["record", "record", "train", "eval", "export", "replay", "record",
                          "train", "record", "diagnose"])
        for words in commands:
            flags = {word for word in words if word.startswith("-")}
            self.assertLessEqual(flags, program_help.flags(words[0]), words)

    def test_scenes_are_there(self):
        scenes = [word for word in self.demo("--dry-run").split() if word.startswith("models/")]
        self.assertEqual([scene for scene in scenes if not (ROOT / scene).is_file()], [])
        self.assertTrue(scenes)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
