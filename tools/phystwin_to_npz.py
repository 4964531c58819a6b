#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a PhysTwin case to a recording and, where its parameters are there, a level-0 twin.

PhysTwin's frame mostly has z down, ours z up: (x, y, z) -> (x, -y, -z), a half turn about x. How
fast a case was filmed and which way z points is read from its metadata.json and configuration.
docs/phystwin.md says more. Needs Python 3.9 and numpy; runs no code that a pickle names.
"""

import argparse
import json
import os
import pathlib
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("phystwin_to_npz: error: needs numpy (apt-get install python3-numpy)")

import phystwin_case
from npz_files import npz_bytes, write_files
from phystwin_settings import LEAST_FPS, MOST_FPS, read_settings
from phystwin_twin import DEFAULT_MASS, GRAVITY, convert_twin
from safe_pickle import Error

GROUND = [0.0, 0.0, 1.0, 0.0]  # z = 0

EXAMPLES = """examples:
  # a case where PhysTwin left it, with its results in experiments_optimization/ and experiments/
  phystwin_to_npz.py PhysTwin/data/different_types/rope_double_hand -o rope.npz --mass 0.06

  # parameters and checkpoint kept elsewhere
  phystwin_to_npz.py sloth -o sloth.npz --parameters optimal_params.pkl --checkpoint best_180.pth

  # the recording alone, to train on
  phystwin_to_npz.py sloth -o sloth.npz --recording-only
"""


def recording_of(case, fps, mass):
    arrays = {
        "points": case.points,
        "controllers": case.controllers,
        "interior": case.interior,
        "fps": np.float64(fps),
        "gravity": np.array(GRAVITY),
        "ground": np.array(GROUND),
    }
    # PhysTwin's Chamfer distance uses all points seen, its track loss those followed
    if not np.array_equal(case.points, case.surface, equal_nan=True):
        arrays["surface"] = case.surface
    if case.track is not None:
        arrays["track"] = case.track
    if case.train_frames is not None:
        arrays["train_frames"] = np.int32(case.train_frames)
    if mass is not None:
        arrays["mass"] = np.float64(mass)
    return arrays


def meta_of(case, name, recording_bytes):
    frames = len(case.points)
    train_frames = case.train_frames if case.train_frames is not None else max(2, frames * 7 // 10)
    meta = {
        "format": "physpring twin", "version": 1, "program": "phystwin_to_npz",
        "name": name, "levels": 1, "points": len(case.tracked), "interior": len(case.interior),
        "controllers": case.controllers.shape[1],
        "controller_velocity": False,  # PhysTwin's dashpots take the controllers to be at rest
        "recordings": [{"name": name, "hash": hash_bytes(recording_bytes),
                        "train_frames": train_frames}],
        "seed": 0, "options": {},
    }
    return np.frombuffer(json.dumps(meta, indent=1).encode(), np.uint8)


def hash_bytes(data):
    """FNV-1a, 64 bits: how twins tell recordings apart."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return f"{value:016x}"


def find_one(patterns):
    """The only file that fits the first of `patterns` (folder, glob) that any file fits."""
    for folder, pattern in patterns:
        found = sorted(folder.glob(pattern))
        if len(found) > 1:
            raise Error(f"{folder}: {len(found)} files {pattern}, choose one with --checkpoint")
        if found:
            return found[0]
    return None


def find_results(folder, args):
    """(parameters, checkpoint): as given, in the case, or where PhysTwin keeps its results."""
    if args.recording_only:
        return None, None
    name, root = folder.name, folder.parent.parent.parent
    parameters = args.parameters or find_one([
        (folder, "optimal_params.pkl"),
        (root / "experiments_optimization" / name, "optimal_params.pkl")])
    checkpoint = args.checkpoint or find_one([
        (folder, "best_*.pth"), (root / "experiments" / name / "train", "best_*.pth")])
    if checkpoint is not None and parameters is None:
        raise Error(f"{checkpoint}: its springs cannot be found again without optimal_params.pkl "
                    "(--parameters FILE, or --recording-only)")
    return parameters, checkpoint


def convert(args):
    """Writes what `args` ask for; the notes about it, a line each."""
    folder, notes = pathlib.Path(os.path.realpath(args.case)), []
    if not folder.is_dir():
        raise Error(f"{args.case}: no such folder")
    settings = read_settings(folder, args, notes.append)
    case = phystwin_case.read_case(folder, settings.reverse_z)
    parameters_path, checkpoint_path = find_results(folder, args)
    recording = npz_bytes(recording_of(case, settings.fps, args.mass))
    files = {args.output: recording}
    report = [f"{args.output}: {len(case.points)} frames, {len(case.tracked)} points, "
              f"{len(case.interior)} interior particles, {case.controllers.shape[1]} controllers"]
    if parameters_path is not None:
        arrays, summary = convert_twin(case, settings, args, parameters_path, checkpoint_path,
                                       notes.append)
        arrays["meta"] = meta_of(case, args.output.stem, recording)
        twin_path = args.output.with_suffix(".twin.npz")
        files[twin_path] = npz_bytes(arrays)
        report.append(f"{twin_path}: {summary}")
    write_files(files)
    print("\n".join(report))
    return notes + doubts(case, settings, args)


def doubts(case, settings, args):
    """What was assumed, and what makes it doubtful whether the recording is right."""
    found = []
    if args.mass is None:
        found.append(f"PhysTwin declares no mass, {DEFAULT_MASS} kg is assumed (--mass KG)")
    unseen = int(np.isnan(case.points[0]).any(axis=1).sum())
    if unseen > 0:
        found.append(f"{unseen} points are not visible in frame 0; the twin has them where "
                     "PhysTwin does")
    flag = "--no-reverse-z" if case.reverse_z else "--reverse-z"
    if settings.reverse_z is None:
        found.append("nothing says which way z points (reverse_z in a configuration): "
                     f"{'down' if case.reverse_z else 'up'} is assumed, which puts most points "
                     f"above the ground ({flag} chooses otherwise)")
    elif np.median(case.tracked[:, 2]) < 0:
        found.append("most points are below the ground: does z point the other way in this case "
                     f"({flag})?")
    if settings.frame_num is not None and settings.frame_num != len(case.points):
        found.append(f"metadata.json says {settings.frame_num:g} frames, final_data.pkl has "
                     f"{len(case.points)}: if some were left out, --fps is that of the rest")
    return found


def parse_arguments(argv):
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n", 1)[0], epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("case", type=pathlib.Path, metavar="CASE",
                        help="folder with final_data.pkl; split.json and gt_track_3d.pkl are used "
                             "where they are there")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="NAME.npz",
                        help="the recording; the twin goes to NAME.twin.npz beside it")
    parser.add_argument("--mass", type=float, metavar="KG",
                        help=f"mass of the object; PhysTwin has none (default: not declared, "
                             f"{DEFAULT_MASS} in the twin)")
    parser.add_argument("--fps", type=float, metavar="N",
                        help="frames a second (default: fps in metadata.json of CASE, else FPS in "
                             "the configuration, else 30)")
    parser.add_argument("--reverse-z", action=argparse.BooleanOptionalAction,
                        help="z points down in CASE (default: reverse_z in the configuration, else "
                             "as most points are above z = 0)")
    parser.add_argument("--config", type=pathlib.Path, metavar="FILE",
                        help="PhysTwin's configuration (default: a yaml file in CASE, else "
                             "configs/cloth.yaml or configs/real.yaml beside data/, by the name of "
                             "CASE, as PhysTwin does)")
    parser.add_argument("--parameters", type=pathlib.Path, metavar="FILE",
                        help="optimal_params.pkl (default: in CASE, or in "
                             "experiments_optimization/ beside PhysTwin's data/)")
    parser.add_argument("--checkpoint", type=pathlib.Path, metavar="FILE",
                        help="best_*.pth (default: in CASE, or in experiments/ beside data/)")
    parser.add_argument("--recording-only", action="store_true", help="write no twin")
    parser.add_argument("--truncate", action=argparse.BooleanOptionalAction,
                        help="cut dashpot and drag to whole numbers, as PhysTwin's second stage "
                             "and inference do (default: yes with a checkpoint, else no)")
    parser.add_argument("--self-collision", action=argparse.BooleanOptionalAction,
                        help="particles collide with each other (default: self_collision in the "
                             "configuration, else for cloth and packages, by the name of CASE)")
    args = parser.parse_args(argv)
    if args.output.suffix != ".npz" or args.output.name.endswith(".twin.npz"):
        parser.error(f"-o {args.output}: expected NAME.npz")
    if args.mass is not None and not 0 < args.mass < float("inf"):
        parser.error(f"--mass {args.mass}: expected more than 0")
    if args.fps is not None and not LEAST_FPS <= args.fps <= MOST_FPS:
        parser.error(f"--fps {args.fps}: expected {LEAST_FPS:g} to {MOST_FPS:g}")
    return args


def main(argv=None):
    args = parse_arguments(argv)
    try:
        for note in convert(args):
            print(f"phystwin_to_npz: note: {note}", file=sys.stderr)
    except Error as error:
        # a damaged file can put anything into a message: one line of it
        print("phystwin_to_npz: error: " + " ".join(str(error).split())[:500], file=sys.stderr)
        return 1
    except OSError as error:  # a folder that may not be looked into
        print(f"phystwin_to_npz: error: {error.filename or args.case}: {error.strerror}",
              file=sys.stderr)
        return 1
    except MemoryError:
        print(f"phystwin_to_npz: error: {args.case}: needs more memory than there is",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
