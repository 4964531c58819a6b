# SPDX-License-Identifier: Apache-2.0
"""Prints one table of what scripts/demo found, from the reports that it leaves.

    demo_table.py --errors errors.json --unseen rope_b.npz --fps 30
                  --diagnosis diagnosis/report.json --truth EFFECT.PARAMETER=VALUE ...

The upper part has the levels of a twin, from the report of `physpring eval`: their nodes, springs,
track error on the recording that training has not seen, and how many seconds they simulate in one.
The lower part has what a diagnosis found, from its report.json: the effects and their parameters
with 95 % intervals, and the track error before and after on frames that were not fitted. --truth
says what is to be found; what was not found is a row of its own. Nothing here is a result: all
figures come from the reports. Needs nothing but Python.
"""

import argparse
import json
import pathlib
import sys

STANDARD_ERRORS = 1.96  # half a 95 % interval
LEVELS = ["twin of the rope", "nodes", "springs", "error, unseen motion", "simulated speed"]
EFFECTS = ["what the cord's twin lacked", "true value", "found", "95 % interval", "error before",
           "after"]


class Wrong(Exception):
    """A report that does not hold what it should; its text is one line."""


def read(path):
    try:
        return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Wrong(f"{path}: no report: {error}") from error


def millimetres(metres):
    return "no data" if metres is None else f"{1e3 * metres:.2f} mm"


def level_rows(errors, unseen, fps):
    """A row a level, and one of a body that does not move. Errors are of the particles that a level
    carries along, which all levels have in common."""
    found = [r for r in errors["recordings"] if pathlib.Path(r["file"]).name == unseen]
    if len(found) != 1 or found[0]["trained_on"]:
        raise Wrong(f"the report holds no recording {unseen} that training has not seen")
    rows = []
    for level in found[0]["levels"]:
        error = level["prediction"]["track_lifted"]
        rows.append([f"level {level['level']}", str(level["nodes"]), str(level["springs"]),
                     millimetres(error), f"{level['fps'] / fps:.0f} x real time"])
    still = found[0]["motionless"]["prediction"]["track"]
    return rows + [["if nothing moved", "", "", millimetres(still), ""]]


def numbers_of(effects):
    """{EFFECT.PARAMETER: (value, standard error)}; of a list each value has its own [place]."""
    numbers = {}
    for effect in effects:
        for key, value in effect["parameters"].items():
            name, error = f"{effect['name']}.{key}", effect["standard_errors"][key]
            if isinstance(value, list):
                for i, pair in enumerate(zip(value, error)):
                    numbers[f"{name}[{i}]"] = pair
            else:
                numbers[name] = (value, error)
    return numbers


def effect_rows(report, truth):
    """A row for each parameter that is true or was found; errors are in the first one."""
    numbers = numbers_of(report["effects"])
    rows = []
    for name in list(truth) + [name for name in numbers if name not in truth]:
        true_value = f"{truth[name]:g}" if name in truth else "not there"
        found, interval = "not found", ""
        if name in numbers:
            value, error = numbers[name]
            half = STANDARD_ERRORS * error
            found, interval = f"{value:.4g}", f"{value - half:.4g} to {value + half:.4g}"
        rows.append([name, true_value, found, interval, "", ""])
    rows = rows or [["nothing", "", "", "", "", ""]]
    rows[0][4:] = [millimetres(report[when]["heldout"]) for when in ("before", "after")]
    return rows


def lines_of(head, rows):
    """The first column to the left, the others to the right, under a line of heads."""
    widths = [max(map(len, column)) for column in zip(head, *rows)]
    for row in [head] + rows:
        cells = [cell.rjust(width) for cell, width in zip(row[1:], widths[1:])]
        yield "  ".join([row[0].ljust(widths[0])] + cells).rstrip()


def table(levels, effects, noise_floor):
    parts = [list(lines_of(LEVELS, levels)), list(lines_of(EFFECTS, effects))]
    rule = "-" * max(len(line) for part in parts for line in part)
    lines = [rule]
    for part in parts:
        lines += [part[0], rule] + part[1:] + [rule]
    return lines + ["errors: mean distance of predicted from measured points; before and after the "
                    "effect was added,",
                    "on frames that were not fitted, where a perfect model would have "
                    f"{millimetres(noise_floor)}"]


def truth_of(text):
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(f"{text} is not EFFECT.PARAMETER=VALUE")
    return name, float(value)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--errors", required=True, help="report of physpring eval --json")
    parser.add_argument("--unseen", required=True, help="file name of the recording to judge by")
    parser.add_argument("--fps", required=True, type=float, help="frames a second of that")
    parser.add_argument("--diagnosis", required=True, help="report.json of physpring diagnose")
    parser.add_argument("--truth", type=truth_of, action="append", default=[],
                        help="EFFECT.PARAMETER=VALUE that the diagnosis is to find")
    given = parser.parse_args(arguments)
    try:
        errors, report = read(given.errors), read(given.diagnosis)
        levels = level_rows(errors, given.unseen, given.fps)
        effects = effect_rows(report, dict(given.truth))
        lines = table(levels, effects, report["noise_floor"])
    except (Wrong, KeyError) as error:
        reason = f"a report has no {error}" if isinstance(error, KeyError) else error
        print(f"demo_table.py: {reason}", file=sys.stderr)
        return 1
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
