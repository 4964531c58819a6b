#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a branched cable of DEFT's data set to recordings with a dataset.json.

DEFT (Chen et al., arXiv 2502.15037, github.com/roahmlab/DEFT) has markers on six real cables with
branches at 100 Hz, dataset/BDLO1 to BDLO6, also BDLO1_mid_clamp and BDLO3_mid_clamp: train/*.pkl and
eval/*.pkl, each x, y, z of 500 frames, markers within frames, in metres with y up. The files do not
say where branches begin: `CABLES` has it from scripts/DEFT_train.py. Held markers are `controllers`,
the others `points`; particles between neighbours along a branch, on a smooth line, are `interior`.
`rod` says which follow each other, `rest` is flat, with straight branches of the mean lengths and
angles of the files to fit. Frame 0 is the second of the file, the first gives the initial velocity.
train/ is to be fitted, eval/ is held out; files of one take have one number. Needs Python 3.9 and
numpy; runs no code that a pickle names."""

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
LOOKS = 4  # frames of a file, for lengths and angles
ENDS = (0, 1, -2, -1)  # held markers of the main branch
# markers of the main branch; of each other one the marker that it begins at, how many more it has, and
# on which side it is when the cable lies flat
CABLES = {
    "BDLO1": (13, ((4, 4, 1), (8, 3, 1)), ENDS),
    "BDLO1_mid_clamp": (13, ((4, 4, 1), (8, 3, 1)), (2, -2, -1)),
    "BDLO2": (12, ((4, 4, 1), (7, 4, 1)), ENDS),
    "BDLO3": (12, ((4, 2, 1), (7, 3, 1)), ENDS),
    "BDLO3_mid_clamp": (12, ((4, 2, 1), (7, 3, 1)), (3, -2, -1)),
    "BDLO4": (12, ((4, 2, 1), (8, 2, 1)), ENDS),
    "BDLO5": (12, ((5, 3, 1), (12, 3, 1)), ENDS),  # the second branch begins on the first one
    "BDLO6": (12, ((2, 4, 1), (7, 2, -1), (7, 3, 1)), ENDS),
}


class Cable:
    """Its topology. branches: numbers of the markers along each, with the one that it begins at."""

    def __init__(self, name):
        main, others, held = CABLES[name]
        self.branches, self.count, self.sides = [list(range(main))], main, [0]
        for start, more, side in others:
            self.branches.append([start, *range(self.count, self.count + more)])
            self.sides.append(side)
            self.count += more
        self.held = [i % main for i in held]
        self.free = [i for i in range(self.count) if i not in self.held]

    def gaps(self, branch):
        """Those that have particles between: not those of which both ends are held."""
        return [i for i, ends in enumerate(zip(branch, branch[1:])) if not set(ends) <= set(self.held)]

    def edges(self, between):
        """Which columns of points, interior and controllers follow each other along a branch."""
        column = {number: i for i, number in enumerate(self.free)}
        inside = [(number, i) for number, branch in enumerate(self.branches) for i in self.gaps(branch)]
        first = {gap: len(self.free) + between * i for i, gap in enumerate(inside)}
        hands = len(self.free) + between * len(inside)
        column.update((number, hands + i) for i, number in enumerate(self.held))
        edges = []
        for number, branch in enumerate(self.branches):
            for i in range(len(branch) - 1):
                gap = first.get((number, i))
                way = [column[branch[i]], *([] if gap is None else range(gap, gap + between)),
                       column[branch[i + 1]]]
                edges.extend(zip(way, way[1:]))
        return edges

    def base(self, number):
        """The branch that another one begins on, and where on it."""
        start = self.branches[number][0]
        for base, branch in enumerate(self.branches[:number]):
            if start in branch[1:]:
                return base, branch.index(start)
        raise AssertionError("a branch begins on another one")


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


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def rest_of(cable, frames, between):
    """Stress-free positions of points, interior and controllers: flat, with straight branches, as long
    and at such angles as on average in `frames` (n, markers, 3)."""
    at, headings, interior = np.zeros((cable.count, 3)), [0.0], []
    for number, branch in enumerate(cable.branches):
        if number > 0:
            base, i = cable.base(number)
            along = cable.branches[base]
            tangent = unit(frames[:, along[i + 1]] - frames[:, along[i - 1]])
            first = unit(frames[:, branch[1]] - frames[:, branch[0]])
            angle = np.arccos(np.clip((tangent * first).sum(1).mean(), -1, 1))
            headings.append(headings[base] + cable.sides[number] * angle)
        lengths = np.mean([parameters_between(frame[branch], 0, [])[1] for frame in frames], axis=0)
        way = np.array([np.cos(headings[-1]), np.sin(headings[-1]), 0])
        at[branch] = at[branch[0]] + lengths[:, None] * way
        part = np.arange(1, between + 1) / (between + 1)
        for i in cable.gaps(branch):
            one, other = at[branch[i]], at[branch[i + 1]]
            interior.append(one + part[:, None] * (other - one))
    return np.concatenate([at[cable.free], *interior, at[cable.held]])


def recording_of(cable, frames, rest, between, mass):
    starts, befores = [], []
    for branch in cable.branches:
        parameters, _, _ = parameters_between(frames[1, branch], between, cable.gaps(branch))
        befores.append(spline(frames[0, branch])(parameters))
        starts.append(spline(frames[1, branch])(parameters))
    interior = np.concatenate(starts)
    before = np.concatenate([frames[0, cable.free], *befores])
    velocity = (np.concatenate([frames[1, cable.free], interior]) - before) * FPS
    return take_arrays({"points": frames[1:, cable.free], "controllers": frames[1:, cable.held],
                        "interior": interior, "velocity": velocity, "rest": rest,
                        "rod": cable.edges(between)},
                       len(frames) - 1, mass)


def place_of(path):
    """The take and where in it a file begins."""
    found = re.fullmatch(r"(.*?)_?block\d+_frames(\d+)to\d+", path.stem)
    return (found[1], int(found[2])) if found else (path.stem, 0)


def convert(args):
    name = args.cable.resolve().name
    if name not in CABLES:
        raise Error(f"{args.cable}: is none of {', '.join(CABLES)}")
    cable = Cable(name)
    found = find_files(args, place_of, lambda path: f"{path.stem}.npz")
    of_file = [place_of(path)[0] for path, _, _ in found]
    takes = sorted(set(of_file))
    markers = [read_markers(path, cable.count) for path, _, _ in found]
    to_fit = [frames for frames, (_, role, _) in zip(markers, found) if role == "fit"] or markers
    rest = rest_of(cable, np.concatenate([frames[::FRAMES // LOOKS] for frames in to_fit]), args.between)
    recordings = (recording_of(cable, frames, rest, args.between, args.mass) for frames in markers)
    done = write_dataset(args, found, [takes.index(take) for take in of_file], recordings,
                         {"name": f"branched cable {name}"})
    print(f"{done}; {cable.count} markers on {len(cable.branches)} branches")


def main(argv=None):
    try:
        convert(parser_of(__doc__, "BDLO").parse_args(argv))
    except (Error, OSError) as error:
        sys.exit(f"deft_to_npz: error: {error}")


if __name__ == "__main__":
    main()
