# SPDX-License-Identifier: Apache-2.0
"""What the importers of motion-captured cables share: lines through markers, particles on them, and
the folder that is written."""

import argparse
import json
import pathlib

import numpy as np

from npz_files import npz_bytes, write_files
from safe_pickle import Error

FPS = 100.0  # 1/s, of DEFORM's and DEFT's recordings
GRAVITY = [0.0, 0.0, -9.81]
DENSE = 200  # steps between markers, for arc lengths


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


def parameters_between(markers, between, gaps):
    """Of `between` particles in each of the gaps (numbers of their first markers): those that share it
    evenly along the line. Also the arc length at the markers and at those particles."""
    dense = np.arange(DENSE * (len(markers) - 1) + 1) / DENSE
    steps = np.linalg.norm(np.diff(spline(markers)(dense), axis=0), axis=1)
    along = np.concatenate([[0], np.cumsum(steps)])
    at_markers = along[::DENSE]
    lengths = np.concatenate([np.linspace(at_markers[i], at_markers[i + 1], between + 2)[1:-1]
                              for i in gaps] or [np.zeros(0)])
    return np.interp(lengths, along, dense), at_markers, lengths


def take_arrays(arrays, frames, mass):
    """A recording's file: arrays of points or lengths in float32, whole numbers as they are, and what
    all of these cables have."""
    arrays = {name: np.asarray(array, np.int32 if np.asarray(array).dtype.kind == "i" else np.float32)
              for name, array in arrays.items()}
    arrays.update(fps=np.float64(FPS), gravity=np.array(GRAVITY), train_frames=np.int32(frames))
    if mass is not None:
        arrays["mass"] = np.float64(mass)
    return arrays


def find_files(args, place, name):
    """[(path, role, file to write)] of train/*.pkl and eval/*.pkl, sorted by place(path); name(path) is
    that of the file."""
    found = [(path, role, name(path)) for folder, role in (("train", "fit"), ("eval", "heldout"))
             for path in (args.cable / folder).glob("*.pkl")]
    if not found:
        raise Error(f"{args.cable}: has no train/*.pkl and no eval/*.pkl")
    if len({file for _, _, file in found}) < len(found):
        raise Error(f"{args.cable}: two files of train/ and eval/ have one name")
    if (args.output / "dataset.json").exists():
        raise Error(f"{args.output}: has a dataset.json already; name another folder, or remove it")
    return sorted(found, key=lambda one: place(one[0]))


def write_dataset(args, found, groups, recordings, dataset):
    """The arrays `recordings` of the files `found`, and dataset.json. Files of one group are of one
    recording. Returns a line that says how many there are."""
    listed = [{"file": file, "role": role, "continuous_recording": group}
              for (_, role, file), group in zip(found, groups)]
    text = json.dumps({**dataset, "recordings": listed}, indent=1) + "\n"
    files = {args.output / file: npz_bytes(arrays) for (_, _, file), arrays in zip(found, recordings)}
    args.output.mkdir(parents=True, exist_ok=True)
    write_files(files)
    write_files({args.output / "dataset.json": text.encode()})
    heldout = sum(role == "heldout" for _, role, _ in found)
    return f"{args.output}: {len(found)} recordings, {heldout} of them held out"


def parser_of(doc, what):
    """Of the command line: folder, --output, --between, --mass."""
    def whole(text):
        if not 0 <= int(text) <= 100:
            raise argparse.ArgumentTypeError("must be 0 to 100")
        return int(text)

    def positive(text):
        if not 0 < float(text) < float("inf"):
            raise argparse.ArgumentTypeError("must be positive and finite")
        return float(text)

    parser = argparse.ArgumentParser(description=doc.split("\n\n", 1)[0])
    parser.add_argument("cable", type=pathlib.Path, metavar=what, help="folder with train/, eval/")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--between", type=whole, default=3, metavar="N",
                        help="particles between neighbouring markers (default: 3)")
    parser.add_argument("--mass", type=positive, metavar="KG",
                        help="of the cable, which the data set does not tell; without contact only "
                             "ratios to it matter")
    return parser
