#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts a PhysTwin case to a recording and, where its parameters are there, a level-0 twin.

PhysTwin's frame has z down, ours z up: (x, y, z) -> (x, -y, -z), a half turn about x. Its particles
weigh 1 kg each and its spring force is Y (l / L - 1); with m = mass / particles, ours has
    stiffness k = Y m / L,   dashpot c m,   drag as it is.
PhysTwin saves no springs, only Y by index: they are searched again here, in the same order.
docs/phystwin.md says more. Needs Python 3.9 and numpy; runs no code that a pickle names.
"""

import argparse
import io
import json
import os
import pathlib
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("phystwin_to_npz: error: needs numpy (apt-get install python3-numpy)")

import phystwin_case
from phystwin_springs import find_springs
from safe_pickle import Error

FPS = 30
SUBSTEPS_PER_SECOND = 667 * FPS  # PhysTwin: 667 sub-steps of 5e-5 s a frame
GRAVITY = [0.0, 0.0, -9.8]  # m/s^2
GROUND = [0.0, 0.0, 1.0, 0.0]  # z = 0
DEFAULT_MASS = 0.1  # kg, what our reader assumes where none is declared
Y_MAX = 1e5  # N; PhysTwin's simulator clamps Y to [0, Y_MAX]

EXAMPLES = """examples:
  # a case where PhysTwin left it, with its results in experiments_optimization/ and experiments/
  phystwin_to_npz.py PhysTwin/data/different_types/rope_double_hand -o rope.npz --mass 0.06

  # parameters and checkpoint kept elsewhere
  phystwin_to_npz.py sloth -o sloth.npz --parameters optimal_params.pkl --checkpoint best_180.pth

  # the recording alone, to train on
  phystwin_to_npz.py sloth -o sloth.npz --recording-only
"""


def note(text):
    print(f"phystwin_to_npz: note: {text}", file=sys.stderr)


def recording_of(case, mass):
    arrays = {
        "points": case.points,
        "controllers": case.controllers,
        "interior": case.interior,
        "fps": np.float64(FPS),
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


def parameters_of(name, springs, object_springs, args, parameters, checkpoint_path):
    """PhysTwin's parameters as its simulator uses them, with Y of each spring."""
    used = dict(parameters, spring_Y=np.full(len(springs), parameters["global_spring_Y"]))
    if checkpoint_path is not None:
        checkpoint = phystwin_case.read_checkpoint(checkpoint_path)
        stored = (len(checkpoint["spring_Y"]), checkpoint["num_object_springs"])
        if stored != (len(springs), object_springs):
            raise Error(f"{checkpoint_path}: holds {stored[0]} springs, {stored[1]} of them "
                        f"between particles, but the case and its parameters give {len(springs)} "
                        f"and {object_springs}: they are not of one run")
        used.update(checkpoint)
    # PhysTwin's second stage makes these two whole numbers: its Y belong to those
    if args.truncate if args.truncate is not None else checkpoint_path is not None:
        used["dashpot_damping"] = float(int(used["dashpot_damping"]))
        used["drag_damping"] = float(int(used["drag_damping"]))
    self_collision = args.self_collision
    if self_collision is None:  # PhysTwin chooses its configuration by name, too
        self_collision = "cloth" in name or "package" in name
    if not self_collision:
        used["collision_dist"] = 0.0
    return used


def twin_of(case, springs, rest_length, parameters, mass):
    """Arrays of level 0."""
    particles = len(case.tracked) + len(case.interior)
    particle_mass = mass / particles
    position = np.concatenate([case.tracked, case.interior, case.controllers[0]])
    spring_Y = parameters["spring_Y"]
    # PhysTwin skips a spring whose Y is not above 0, its dashpot with it
    dashpot = np.where(spring_Y > 0, parameters["dashpot_damping"] * particle_mass, 0.0)
    return {
        "fps": np.float64(FPS),
        "gravity": np.array(GRAVITY),
        "level0/position": position.astype(np.float64),
        "level0/mass": np.full(particles, particle_mass),
        "level0/springs": springs,
        "level0/rest_length": rest_length,
        "level0/stiffness": np.clip(spring_Y, 0, Y_MAX) * particle_mass / rest_length,
        "level0/dashpot": dashpot,
        "level0/drag": np.float64(parameters["drag_damping"]),
        "level0/contact_radius": np.zeros(particles),
        "level0/restitution": np.float64(np.clip(parameters["collide_elas"], 0, 1)),
        "level0/friction": np.float64(np.clip(parameters["collide_fric"], 0, 2)),
        "level0/object_restitution": np.float64(np.clip(parameters["collide_object_elas"], 0, 1)),
        "level0/object_friction": np.float64(np.clip(parameters["collide_object_fric"], 0, 2)),
        "level0/collision_distance": np.float64(parameters["collision_dist"]),
        "level0/substeps_per_second": np.int32(SUBSTEPS_PER_SECOND),
    }


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


def npz_bytes(arrays):
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def hash_bytes(data):
    """FNV-1a, 64 bits: how twins tell recordings apart."""
    value = 0xCBF29CE484222325
    for byte in data:
        value = ((value ^ byte) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return f"{value:016x}"


def write_files(files):
    """Writes {path: bytes}: all of them whole, or none."""
    for path in files:
        if path.is_dir():
            raise Error(f"{path}: is a folder")
    temporary = {path: path.with_name(f".{path.name}.{os.getpid()}.tmp") for path in files}
    try:
        for path, data in files.items():
            with open(temporary[path], "xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
        for path in files:
            os.replace(temporary[path], path)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    finally:
        for path in temporary.values():
            path.unlink(missing_ok=True)


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


def convert_twin(case, name, args, parameters_path, checkpoint_path):
    """(arrays of the twin without `meta`, a line about it)."""
    parameters = phystwin_case.read_parameters(parameters_path)
    springs, rest_length, object_springs = find_springs(
        np.concatenate([case.tracked, case.interior]), case.controllers[0], parameters)
    if object_springs == 0:
        raise Error(f"{parameters_path}: object_radius {parameters['object_radius']} m joins no "
                    "two particles")
    used = parameters_of(name, springs, object_springs, args, parameters, checkpoint_path)
    arrays = twin_of(case, springs, rest_length, used, args.mass or DEFAULT_MASS)
    return arrays, (f"{len(springs)} springs, {object_springs} of them between particles; drag "
                    f"{used['drag_damping']:.6g} 1/s, dashpot {used['dashpot_damping']:.6g} N s/m "
                    f"at 1 kg a particle, collision distance {used['collision_dist']:.6g} m")


def convert(args):
    folder = args.case.resolve()
    if not folder.is_dir():
        raise Error(f"{args.case}: no such folder")
    case = phystwin_case.read_case(folder)
    parameters_path, checkpoint_path = find_results(folder, args)
    recording = npz_bytes(recording_of(case, args.mass))
    files = {args.output: recording}
    report = [f"{args.output}: {len(case.points)} frames, {len(case.tracked)} points, "
              f"{len(case.interior)} interior particles, {case.controllers.shape[1]} controllers"]
    if parameters_path is not None:
        arrays, summary = convert_twin(case, folder.name, args, parameters_path, checkpoint_path)
        arrays["meta"] = meta_of(case, args.output.stem, recording)
        twin_path = args.output.with_suffix(".twin.npz")
        files[twin_path] = npz_bytes(arrays)
        report.append(f"{twin_path}: {summary}")
    write_files(files)
    print("\n".join(report))
    if args.mass is None:
        note(f"PhysTwin declares no mass, {DEFAULT_MASS} kg is assumed (--mass KG)")
    unseen = int(np.isnan(case.points[0]).any(axis=1).sum())
    if unseen > 0:
        note(f"{unseen} points are not visible in frame 0; the twin has them where PhysTwin does")
    if np.median(case.tracked[:, 2]) < 0:
        note("most points are below the ground: does z point down in this case?")


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
                        help="particles collide with each other (default: for cloth and packages, "
                             "by the name of CASE, as PhysTwin does)")
    args = parser.parse_args(argv)
    if args.output.suffix != ".npz" or args.output.name.endswith(".twin.npz"):
        parser.error(f"-o {args.output}: expected NAME.npz")
    if args.mass is not None and not 0 < args.mass < float("inf"):
        parser.error(f"--mass {args.mass}: expected more than 0")
    return args


def main(argv=None):
    args = parse_arguments(argv)
    try:
        convert(args)
    except Error as error:
        # a damaged file can put anything into a message: one line of it
        print("phystwin_to_npz: error: " + " ".join(str(error).split())[:500], file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
