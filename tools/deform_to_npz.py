#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a cable of DEFORM's data set to recordings with a dataset.json.

DEFORM (Chen et al., CoRL 2024, github.com/roahmlab/DEFORM) has markers on five real cables at 100 Hz,
DLO/train/*.pkl and DLO/eval/*.pkl: (T, 3, markers) in metres. The two outer markers at each end are
held: `controllers`. The others are `points`, with particles between neighbours on a smooth line as
`interior`, and the arc length as `order`. Frame 0 is the second of the file, as in the published
protocol; the first gives the initial velocity. train/ is to be fitted, eval/ is held out. Needs Python
3.9 and numpy; runs no code that a pickle names."""

import argparse
import json
import pathlib
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("deform_to_npz: error: needs numpy (apt-get install python3-numpy)")

from npz_files import npz_bytes, write_files
from safe_pickle import Error, read_pickle

FPS = 100.0  # 1/s
HELD = 2  # markers at each end
GRAVITY = [0.0, 0.0, -9.81]
DENSE = 200  # steps between markers, for arc lengths
SAME = 0.02  # m: a file that begins so near to the frame after another's last goes on with it


def read_markers(path):
    """(T, markers, 3)."""
    value = read_pickle(path)
    value = value.numpy() if hasattr(value, "numpy") else value
    try:
        frames = np.array(value, float)
    except (TypeError, ValueError):
        raise Error(f"{path}: is no list of frames of numbers") from None
    if frames.ndim != 3 or frames.shape[1] != 3 or frames.shape[2] < 2 * HELD + 1 or len(frames) < 4:
        raise Error(f"{path}: has shape {frames.shape}; (T, 3, markers) is expected, of 4 frames or "
                    f"more and {2 * HELD + 1} markers or more")
    if not np.isfinite(frames).all():
        raise Error(f"{path}: has a number that is not finite")
    return frames.transpose(0, 2, 1)


def spline(markers):
    """A natural cubic spline through (n, ...) at 0, 1 .. n-1: a function of parameters."""
    n = len(markers)
    flat = markers.reshape(n, -1)
    system, right = np.eye(n), np.zeros_like(flat)
    for i in range(1, n - 1):
        system[i, i - 1:i + 2] = 1, 4, 1
        right[i] = 6 * (flat[i + 1] - 2 * flat[i] + flat[i - 1])
    bend = np.linalg.solve(system, right)

    def at(parameters):
        i = np.clip(parameters.astype(int), 0, n - 2)
        s = (parameters - i)[:, None]
        t = 1 - s
        values = (t * flat[i] + s * flat[i + 1] +
                  ((t ** 3 - t) * bend[i] + (s ** 3 - s) * bend[i + 1]) / 6)
        return values.reshape((len(parameters), *markers.shape[1:]))
    return at


def parameters_between(markers, between):
    """Of the particles between neighbours, from the first free gap to the last one: those that share
    each gap evenly along the line. Also the arc length at the markers and at those particles."""
    dense = np.arange(DENSE * (len(markers) - 1) + 1) / DENSE
    steps = np.linalg.norm(np.diff(spline(markers)(dense), axis=0), axis=1)
    along = np.concatenate([[0], np.cumsum(steps)])
    at_markers = along[::DENSE]
    lengths = np.concatenate([
        np.linspace(at_markers[i], at_markers[i + 1], between + 2)[1:-1]
        for i in range(HELD - 1, len(markers) - HELD)] or [np.zeros(0)])
    return np.interp(lengths, along, dense), at_markers, lengths


def recording_of(frames, between, mass):
    count = frames.shape[1]
    held = [*range(HELD), *range(count - HELD, count)]
    free = range(HELD, count - HELD)
    parameters, at_markers, lengths = parameters_between(frames[1], between)
    before, start = (spline(frames[i])(parameters) for i in (0, 1))
    velocity = np.concatenate([frames[1, free] - frames[0, free], start - before]) * FPS
    positions = {"points": frames[1:, free], "controllers": frames[1:, held], "interior": start,
                 "velocity": velocity,
                 "order": np.concatenate([at_markers[free], lengths, at_markers[held]])}
    arrays = {name: array.astype(np.float32) for name, array in positions.items()}
    arrays.update(fps=np.float64(FPS), gravity=np.array(GRAVITY),
                  train_frames=np.int32(len(frames) - 1))
    if mass is not None:
        arrays["mass"] = np.float64(mass)
    return arrays


def number_in(path):
    digits = "".join(c for c in path.stem if c.isdigit())
    return int(digits) if digits else 0


def continuous(files):
    """A number for each file: the same where one goes on with what the one before it ended with."""
    numbers, group, end = [], -1, None
    for frames in files:
        if end is None or np.abs(frames[0] - end).max() > SAME:
            group += 1
        numbers.append(group)
        end = 2 * frames[-1] - frames[-2]  # where the next frame would be
    return numbers


def convert(args):
    found = [(path, role) for folder, role in (("train", "fit"), ("eval", "heldout"))
             for path in (args.cable / folder).glob("*.pkl")]
    if not found:
        raise Error(f"{args.cable}: has no train/*.pkl and no eval/*.pkl")
    found.sort(key=lambda one: (number_in(one[0]), one[0].name))
    markers = [read_markers(path) for path, _ in found]
    counts = sorted({frames.shape[1] for frames in markers})
    if len(counts) > 1:
        raise Error(f"{args.cable}: files have {counts[0]} to {counts[-1]} markers; one cable has as "
                    "many in all")
    if (args.output / "dataset.json").exists():
        raise Error(f"{args.output}: has a dataset.json already; name another folder, or remove it")
    names = [f"{path.stem.zfill(3)}.npz" for path, _ in found]
    if len(set(names)) < len(names):
        raise Error(f"{args.cable}: two files of train/ and eval/ have one name")
    listed = [{"file": name, "role": role, "continuous_recording": group}
              for name, (_, role), group in zip(names, found, continuous(markers))]
    dataset = {"name": f"cable {args.cable.resolve().name}", "published_l1_m": {},
               "recordings": listed}
    args.output.mkdir(parents=True, exist_ok=True)
    write_files({args.output / name: npz_bytes(recording_of(frames, args.between, args.mass))
                 for name, frames in zip(names, markers)})
    write_files({args.output / "dataset.json": (json.dumps(dataset, indent=1) + "\n").encode()})
    heldout = sum(role == "heldout" for _, role in found)
    print(f"{args.output}: {len(found)} recordings of {counts[0]} markers, {heldout} of them held out")


def parse_arguments(argv):
    def whole(text):
        if not 0 <= int(text) <= 100:
            raise argparse.ArgumentTypeError("must be 0 to 100")
        return int(text)

    def positive(text):
        if not 0 < float(text) < float("inf"):
            raise argparse.ArgumentTypeError("must be positive and finite")
        return float(text)

    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("cable", type=pathlib.Path, metavar="DLO", help="folder with train/, eval/")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--between", type=whole, default=3, metavar="N",
                        help="particles between neighbouring markers (default: 3)")
    parser.add_argument("--mass", type=positive, metavar="KG",
                        help="of the cable, which DEFORM does not tell; without contact only ratios "
                             "to it matter")
    return parser.parse_args(argv)


def main(argv=None):
    args = parse_arguments(argv)
    try:
        convert(args)
    except (Error, OSError) as error:
        sys.exit(f"deform_to_npz: error: {error}")


if __name__ == "__main__":
    main()
