#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares our sub-step with the same law in NVIDIA Warp on its CPU backend, on one core.

Both simulate the twin of make_rope_twin.py: at rest in its reference position on the ground z = 0,
loss = sum of |x_i - x_i(0)|^2 after the last sub-step. Four programs take turns, so that a busy
machine slows all of them: ours in float and in double, Warp with PhysTwin's kernels and Warp with a
leaner spring kernel. The figures are the medians over the rounds of Warp's time / ours.

Our command prints one line of JSON with us_per_substep_forward, us_per_substep_gradient (forward
and backward together) and loss, which must agree with Warp's. pip installs Warp into .deps/warp.
"""

import argparse
import json
import os
import pathlib
import shlex
import statistics
import subprocess
import sys

WARP = "warp-lang==1.19.0"
BENCH = pathlib.Path(__file__).resolve().parent
ROOT = BENCH.parent
OURS = f"{ROOT}/build/release/bench/time_twin"
OPTIONS = "{twin} --substeps {substeps} --precision {precision}"
LOSS_TOLERANCE = 1e-2  # relative; rounding moves the sub-step of a contact
DIRECTIONS = ("forward", "gradient")


def install_warp(folder):
    """The interpreter of a virtual environment that has Warp."""
    python = folder / "bin" / "python"
    if not (folder / WARP).exists():
        try:
            subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
            subprocess.run([python, "-m", "pip", "install", "--quiet", WARP, "numpy"], check=True)
        except subprocess.CalledProcessError:
            sys.exit("compare_with_warp: cannot install Warp (needs python3-venv and PyPI); "
                     "--warp-python PYTHON names an interpreter that has it")
        (folder / WARP).touch()
    return str(python)


def measure(command, core):
    """The JSON that `command` prints last when it runs on one core."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            preexec_fn=lambda: os.sched_setaffinity(0, {core}), check=False)
    if result.returncode != 0:
        sys.exit(f"compare_with_warp: {shlex.join(command)} failed:\n{result.stderr}")
    return json.loads(result.stdout.splitlines()[-1])


def compare(args, python):
    twin = str(ROOT / ".deps" / "rope.twin.npz")
    subprocess.run([python, BENCH / "make_rope_twin.py", twin], check=True)
    fill = {"twin": twin, "substeps": args.substeps}
    commands = {
        "ours_float": shlex.split(args.ours.format(precision="float", **fill)),
        "warp": [python, str(BENCH / "warp_spring_mass.py"), twin, "--substeps",
                 str(args.substeps)],
        "ours_double": shlex.split(args.ours.format(precision="double", **fill)),
    }
    commands["warp_lean"] = commands["warp"] + ["--lean"]
    core = max(os.sched_getaffinity(0))
    measure(commands["warp"], core)  # Warp compiles its kernels once
    results = {name: [] for name in commands}
    for pair in range(args.pairs):
        for name, command in commands.items():
            results[name].append(measure(command, core))
            times = " ".join(f"{d} {results[name][-1]['us_per_substep_' + d]:8.1f} us"
                             for d in DIRECTIONS)
            print(f"pair {pair + 1} {name:12s} {times}", file=sys.stderr)
    return results


def summary_of(results):
    summary = {"nodes": results["warp"][0]["nodes"], "springs": results["warp"][0]["springs"],
               "pairs": len(results["warp"])}
    for direction in DIRECTIONS:
        key = "us_per_substep_" + direction
        for name, runs in results.items():
            summary[f"{name}_{key}"] = statistics.median(run[key] for run in runs)
        for ours in ("ours_float", "ours_double"):
            for warp in ("warp", "warp_lean"):
                summary[f"{warp}_over_{ours}_{direction}"] = statistics.median(
                    w[key] / o[key] for w, o in zip(results[warp], results[ours]))
    return summary


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ours", default=f"{OURS} {OPTIONS}", metavar="COMMAND",
                        help=f"our benchmark (default: build/release/bench/... {OPTIONS})")
    parser.add_argument("--warp-python", metavar="PYTHON",
                        help="an interpreter that has warp and numpy (default: install it)")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--substeps", type=int, default=667, help="of a rollout (default 667)")
    args = parser.parse_args()

    python = args.warp_python or install_warp(ROOT / ".deps" / "warp")
    results = compare(args, python)
    print(json.dumps(summary_of(results)))
    warp = results["warp"][0]["loss"]
    for name, runs in results.items():
        if abs(runs[0]["loss"] - warp) > LOSS_TOLERANCE * abs(warp):
            sys.exit(f"compare_with_warp: {name} ends with loss {runs[0]['loss']}, warp with {warp}"
                     ": they do not simulate the same")


if __name__ == "__main__":
    main()
