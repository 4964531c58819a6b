#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a cable of DEFORM's data set to recordings with a dataset.json.

DEFORM (Chen et al., CoRL 2024, github.com/roahmlab/DEFORM) has markers on five real cables at 100 Hz,
DLO/train/*.pkl and DLO/eval/*.pkl: (T, 3, markers) in metres. The two outer markers at each end are
held: `controllers`. The others are `points`, with particles between neighbours on a smooth line as
`interior`, and the arc length as `order`. Frame 0 is the second of the file, as in the published
protocol; the first gives the initial velocity. train/ is to be fitted, eval/ is held out. Needs Python
3.9 and numpy; runs no code that a pickle names."""

import sys

try:
    import numpy as np
except ImportError:
    sys.exit("deform_to_npz: error: needs numpy (apt-get install python3-numpy)")

from cable_files import (FPS, find_files, parameters_between, parser_of, spline, take_arrays,
                         write_dataset)
from safe_pickle import Error, read_pickle

HELD = 2  # markers at each end
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


def recording_of(frames, between, mass):
    count = frames.shape[1]
    held = [*range(HELD), *range(count - HELD, count)]
    free = range(HELD, count - HELD)
    gaps = range(HELD - 1, count - HELD)
    parameters, at_markers, lengths = parameters_between(frames[1], between, gaps)
    before, start = (spline(frames[i])(parameters) for i in (0, 1))
    velocity = np.concatenate([frames[1, free] - frames[0, free], start - before]) * FPS
    order = np.concatenate([at_markers[free], lengths, at_markers[held]])
    return take_arrays({"points": frames[1:, free], "controllers": frames[1:, held],
                        "interior": start, "velocity": velocity, "order": order},
                       len(frames) - 1, mass)


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
    found = find_files(args, lambda path: (number_in(path), path.name),
                       lambda path: f"{path.stem.zfill(3)}.npz")
    markers = [read_markers(path) for path, _, _ in found]
    counts = sorted({frames.shape[1] for frames in markers})
    if len(counts) > 1:
        raise Error(f"{args.cable}: files have {counts[0]} to {counts[-1]} markers; one cable has as "
                    "many in all")
    recordings = (recording_of(frames, args.between, args.mass) for frames in markers)
    dataset = {"name": f"cable {args.cable.resolve().name}", "published_l1_m": {}}
    print(f"{write_dataset(args, found, continuous(markers), recordings, dataset)}; {counts[0]} markers")


def main(argv=None):
    try:
        convert(parser_of(__doc__, "DLO").parse_args(argv))
    except (Error, OSError) as error:
        sys.exit(f"deform_to_npz: error: {error}")


if __name__ == "__main__":
    main()
