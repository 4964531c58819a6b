#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Converts the pictures of a PhysTwin case to a folder that eval --images and fit-splats read.

It takes color/, depth/, mask/, calibrate.pkl and metadata.json of the case. Frames, cameras and
their frame of reference are those of the recording that phystwin_to_npz.py makes. The object's mask
becomes 255, the controller's ("hand") 128: PhysTwin compares nothing there. docs/phystwin.md says
more. Needs Python 3.9, numpy and Pillow; runs no code that a pickle names.
"""

import argparse
import json
import pathlib
import shutil
import sys
import tempfile

try:
    import numpy as np
    from PIL import Image
except ImportError as missing:
    sys.exit(f"phystwin_pictures: error: needs numpy and Pillow ({missing})")

from phystwin_settings import read_json, read_settings
from safe_pickle import Error, read_pickle

CONTROLLER = "hand"
HIDDEN, OBJECT = 128, 255
DEPTH_UNIT = 0.001  # PhysTwin's depths are whole millimetres
HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])  # about x: z down to z up


def read_picture(path, size):
    try:
        with Image.open(path) as picture:
            if picture.size != size:
                raise Error(f"{path}: has {picture.size[0]} x {picture.size[1]} pixels; metadata.json "
                            f"says {size[0]} x {size[1]}")
            return np.asarray(picture.convert("RGB"))
    except OSError as error:
        raise Error(f"{path}: {error}") from None


def is_set(path, size):
    return read_picture(path, size).any(axis=2)


class Case:
    """A case's cameras, and where its pictures are."""

    def __init__(self, folder, reverse_z):
        self.folder = folder
        metadata = read_json(folder / "metadata.json")
        try:
            self.size = tuple(int(n) for n in metadata["WH"])
            self.intrinsics = np.array(metadata["intrinsics"], float)
            self.frames = int(metadata["frame_num"])
        except (KeyError, TypeError, ValueError) as error:
            raise Error(f"{folder / 'metadata.json'}: lacks WH, intrinsics or frame_num "
                        f"({error})") from None
        poses = read_pickle(folder / "calibrate.pkl")
        try:
            poses = poses.numpy() if hasattr(poses, "numpy") else [pose.numpy() for pose in poses]
            self.poses = [np.array(pose, float).reshape(4, 4) for pose in poses]
        except (AttributeError, TypeError, ValueError):
            raise Error(f"{folder / 'calibrate.pkl'}: is no list of 4 x 4 matrices") from None
        if not np.isfinite(self.intrinsics).all() or self.frames < 1:
            raise Error(f"{folder / 'metadata.json'}: has intrinsics that are not finite, or no frame")
        if self.intrinsics.shape != (len(self.poses), 3, 3) or len(self.size) != 2:
            raise Error(f"{folder}: has {len(self.poses)} poses in calibrate.pkl, and intrinsics of "
                        f"shape {self.intrinsics.shape} in metadata.json")
        if reverse_z:
            self.poses = [HALF_TURN @ pose for pose in self.poses]
        self.masks = [self.mask_numbers(camera) for camera in range(len(self.poses))]

    def mask_numbers(self, camera):
        """(the object's number, those of controllers) in mask/CAMERA/."""
        path = self.folder / "mask" / f"mask_info_{camera}.json"
        names = read_json(path)
        if not isinstance(names, dict) or not all(key.isdigit() for key in names):
            raise Error(f"{path}: is no object of a name for each mask's number")
        objects = [int(key) for key, name in names.items() if name != CONTROLLER]
        if len(objects) != 1:
            raise Error(f"{path}: names {len(objects)} objects beside {CONTROLLER!r}; one is expected")
        return objects[0], [int(key) for key, name in names.items() if name == CONTROLLER]

    def camera(self, number):
        k = self.intrinsics[number]
        # PhysTwin has the centre of the first pixel at (0, 0), we at (0.5, 0.5)
        return {"name": str(number), "width": self.size[0], "height": self.size[1],
                "fx": k[0, 0], "fy": k[1, 1], "cx": k[0, 2] + 0.5, "cy": k[1, 2] + 0.5,
                "pose": self.poses[number].ravel().tolist()}

    def color(self, camera, frame):
        return read_picture(self.folder / "color" / str(camera) / f"{frame}.png", self.size)

    def mask(self, camera, frame):
        number, controllers = self.masks[camera]
        folder = self.folder / "mask" / str(camera)
        mask = np.zeros(self.size[::-1], np.uint8)
        mask[is_set(folder / str(number) / f"{frame}.png", self.size)] = OBJECT
        for controller in controllers:
            mask[is_set(folder / str(controller) / f"{frame}.png", self.size)] = HIDDEN
        return mask

    def depth(self, camera, frame):
        path = self.folder / "depth" / str(camera) / f"{frame}.npy"
        try:
            depth = np.load(path, allow_pickle=False)
        except (OSError, ValueError) as error:
            raise Error(f"{path}: {error}") from None
        if depth.dtype.kind not in "uif":
            raise Error(f"{path}: holds no numbers")
        if depth.shape != self.size[::-1]:
            raise Error(f"{path}: has shape {depth.shape}; {self.size[::-1]} is expected")
        return np.clip(np.nan_to_num(depth), 0, 65535).astype(np.uint16)

    @property
    def has_depth(self):
        return (self.folder / "depth").is_dir()


def write(picture, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(picture).save(path)


def write_all(case, settings, folder):
    for camera in range(len(case.poses)):
        for frame in range(case.frames):
            name = f"{camera}/{frame:05}.png"
            write(case.color(camera, frame), folder / "color" / name)
            write(case.mask(camera, frame), folder / "mask" / name)
            if case.has_depth:
                write(case.depth(camera, frame), folder / "depth" / name)
    cameras = {"format": "physpring pictures", "version": 1, "fps": settings.fps,
               "frames": case.frames}
    if case.has_depth:
        cameras["depth_unit"] = DEPTH_UNIT
    cameras["cameras"] = [case.camera(camera) for camera in range(len(case.poses))]
    (folder / "cameras.json").write_text(json.dumps(cameras, indent=1) + "\n")


def convert(args):
    """Writes the folder whole, or not at all."""
    notes = []
    settings = read_settings(args.case, args, notes.append)
    case = Case(args.case, settings.reverse_z is not False)
    if settings.reverse_z is None:
        notes.append("nothing says which way z points: down is assumed (--no-reverse-z)")
    if args.output.exists():
        raise Error(f"{args.output}: is there already; name another folder, or remove it")
    args.output.parent.mkdir(parents=True, exist_ok=True)
    draft = pathlib.Path(tempfile.mkdtemp(prefix=f".{args.output.name}.", dir=args.output.parent))
    try:
        write_all(case, settings, draft)
        draft.chmod(0o755)
        draft.rename(args.output)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    print(f"{args.output}: {case.frames} frames of {len(case.poses)} cameras")
    return notes


def parse_arguments(argv):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("case", type=pathlib.Path, metavar="CASE")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--fps", type=float, metavar="N", help="as in phystwin_to_npz.py")
    parser.add_argument("--reverse-z", action=argparse.BooleanOptionalAction,
                        help="as in phystwin_to_npz.py")
    parser.add_argument("--config", type=pathlib.Path, metavar="FILE",
                        help="as in phystwin_to_npz.py")
    parser.set_defaults(self_collision=None)  # which pictures do not show
    return parser.parse_args(argv)


def main(argv=None):
    args = parse_arguments(argv)
    try:
        notes = convert(args)
    except (Error, OSError) as error:
        sys.exit(f"phystwin_pictures: error: {error}")
    except KeyboardInterrupt:
        sys.exit("phystwin_pictures: stopped; nothing was written")
    for note in notes:
        print(f"phystwin_pictures: note: {note}", file=sys.stderr)


if __name__ == "__main__":
    main()
