#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a branched cable of DEFT's data set to recordings with a dataset.json.

DEFT (Chen et al., arXiv 2502.15037, github.com/roahmlab/DEFT) has markers on six real cables with
branches at 100 Hz, dataset/BDLO1 to BDLO6, also BDLO1_mid_clamp and BDLO3_mid_clamp: train/*.pkl and
eval/*.pkl, each x, y, z of 500 frames, markers within frames, in metres with y up. The files do not
say where branches begin: `CABLES` has it from scripts/DEFT_train.py. Held markers are `controllers`,
the others `points`; particles between neighbours along a branch, on a smooth line, are `interior`.
Frame 0 is the second of the file, the first gives the initial velocity. train/ is to be fitted, eval/
is held out; files of one take have one number. Needs Python 3.9 and numpy; runs no code that a pickle
names."""

import re
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("deft_to_npz: error: needs numpy (apt-get install python3-numpy)")

from cable_files import (FPS, find_files, parameters_between, parser_of, spline, take_arrays,
                         write_dataset)
from safe_pickle import Error, read_pickle

FRAMES = 500  # a file
ENDS = (0, 1, -2, -1)  # held markers of the main branch
# markers of the main branch; of each other one the marker that it begins at, and how many more it has
CABLES = {
    "BDLO1": (13, ((4, 4), (8, 3)), ENDS),
    "BDLO1_mid_clamp": (13, ((4, 4), (8, 3)), (2, -2, -1)),
    "BDLO2": (12, ((4, 4), (7, 4)), ENDS),
    "BDLO3": (12, ((4, 2), (7, 3)), ENDS),
    "BDLO3_mid_clamp": (12, ((4, 2), (7, 3)), (3, -2, -1)),
    "BDLO4": (12, ((4, 2), (8, 2)), ENDS),
    "BDLO5": (12, ((5, 3), (12, 3)), ENDS),  # the second branch begins on the first one
    "BDLO6": (12, ((2, 4), (7, 2), (7, 3)), ENDS),
}


def branches_of(cable):
    """Numbers of the markers along each branch, with the one that it begins at."""
    main, others, _ = CABLES[cable]
    branches, count = [list(range(main))], main
    for start, more in others:
        branches.append([start, *range(count, count + more)])
        count += more
    return branches, count


def read_markers(path, count):
    """(500, count, 3), z up."""
    value = read_pickle(path)
    try:
        numbers = np.array(value, float)
    except (TypeError, ValueError):
        raise Error(f"{path}: is no list of x, y and z") from None
    numbers = numbers[0] if numbers.ndim == 3 and len(numbers) == 1 else numbers
    if numbers.shape != (3, FRAMES * count):
        raise Error(f"{path}: has shape {numbers.shape}; (3, {FRAMES * count}) is expected: {FRAMES} "
                    f"frames of {count} markers")
    if not np.isfinite(numbers).all():
        raise Error(f"{path}: has a number that is not finite")
    x, y, z = numbers.reshape(3, FRAMES, count)
    return np.stack([-z, -x, y], axis=-1)


def recording_of(frames, branches, held, between, mass):
    free = [i for i in range(frames.shape[1]) if i not in held]
    starts, befores = [], []
    for branch in branches:
        gaps = [i for i, ends in enumerate(zip(branch, branch[1:])) if not set(ends) <= set(held)]
        parameters, _, _ = parameters_between(frames[1, branch], between, gaps)
        befores.append(spline(frames[0, branch])(parameters))
        starts.append(spline(frames[1, branch])(parameters))
    interior = np.concatenate(starts)
    before = np.concatenate([frames[0, free], *befores])
    velocity = (np.concatenate([frames[1, free], interior]) - before) * FPS
    return take_arrays({"points": frames[1:, free], "controllers": frames[1:, held],
                        "interior": interior, "velocity": velocity}, len(frames) - 1, mass)


def place_of(path):
    """The take and where in it a file begins."""
    found = re.fullmatch(r"(.*?)_?block\d+_frames(\d+)to\d+", path.stem)
    return (found[1], int(found[2])) if found else (path.stem, 0)


def convert(args):
    cable = args.cable.resolve().name
    if cable not in CABLES:
        raise Error(f"{args.cable}: is none of {', '.join(CABLES)}")
    branches, count = branches_of(cable)
    held = [i % len(branches[0]) for i in CABLES[cable][2]]
    found = sorted(find_files(args.cable), key=lambda one: place_of(one[0]))
    takes = sorted({place_of(path)[0] for path, _ in found})
    names = [f"{path.stem}.npz" for path, _ in found]
    if len(set(names)) < len(names):
        raise Error(f"{args.cable}: two files of train/ and eval/ have one name")
    recordings = {name: recording_of(read_markers(path, count), branches, held, args.between, args.mass)
                  for name, (path, _) in zip(names, found)}
    listed = [{"file": name, "role": role, "continuous_recording": takes.index(place_of(path)[0])}
              for name, (path, role) in zip(names, found)]
    write_dataset(args.output, recordings, {"name": f"branched cable {cable}", "recordings": listed})
    heldout = sum(role == "heldout" for _, role in found)
    print(f"{args.output}: {len(found)} recordings of {count} markers on {len(branches)} branches, "
          f"{heldout} of them held out")


def main(argv=None):
    try:
        convert(parser_of(__doc__, "BDLO").parse_args(argv))
    except (Error, OSError) as error:
        sys.exit(f"deft_to_npz: error: {error}")


if __name__ == "__main__":
    main()
