#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a recording of what sensors and trackers write:
    tracks   2-D tracks of pixels with depth images of one or several cameras -> points
    depth    masks with depth images of one or several cameras -> clouds
    clouds   a folder of point clouds (.npy, .ply, .pcd), one a frame -> clouds
    c3d      markers of motion capture -> points
Clouds go through `physpring register` next. docs/sensors.md says where the arrays come from. Needs
Python 3.9 and numpy; Pillow for .png images; ezc3d for c3d."""

import argparse
import pathlib
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("sensors_to_npz: error: needs numpy (apt-get install python3-numpy)")

from cloud_files import read_cloud
from depth_camera import Camera, cloud_of, depth_at, thinned
from npz_files import npz_bytes, write_files
from safe_pickle import Error
from sensor_files import array_of_npz, files_in, images_in, read_tracks

EXAMPLES = """examples:
  # CoTracker or TAPIR on one camera
  sensors_to_npz.py tracks --view tracks.npz depth/ camera.json --controllers hand.npy --fps 30 \\
      -o rope.npz

  # masks of two depth cameras; then physpring register clouds.npz -o rope.npz
  sensors_to_npz.py depth --view masks_0/ depth_0/ camera_0.json \\
      --view masks_1/ depth_1/ camera_1.json --controllers hand.npy --fps 30 -o clouds.npz

  # motion capture; the markers on the gripper hold the object
  sensors_to_npz.py c3d take.c3d --held gripper_1,gripper_2 --up y -o rope.npz
"""


def points_of_view(view, options):
    """(T, N, 3) of one camera; NaN where a point is not visible or has no depth."""
    tracks_file, folder, camera_file = view
    camera, tracks = Camera(camera_file), read_tracks(tracks_file)
    points = np.full(tracks.shape[:2] + (3,), np.nan)
    count = 0
    for count, image in enumerate(images_in(folder, options.depth_unit), 1):
        if count > len(tracks):
            break
        pixels = tracks[count - 1]
        points[count - 1] = camera.to_world(pixels, depth_at(image, np.nan_to_num(pixels, nan=-9)))
    if count != len(tracks):
        raise Error(f"{folder}: has {'more' if count > len(tracks) else count} depth images, "
                         f"but {tracks_file} has {len(tracks)} frames")
    return points


def joined_frames(of_views, what):
    """Arrays (T, n, 3) of several views, side by side."""
    if len({len(one) for one in of_views}) > 1:
        raise Error(f"views differ in their number of {what} frames: "
                         f"{', '.join(str(len(one)) for one in of_views)}")
    return np.concatenate(of_views, axis=1)


def padded(clouds):
    """(T, S, 3), filled up with NaN."""
    most = max(len(cloud) for cloud in clouds)
    if most == 0:
        raise Error("no frame has any point: are masks and depth of the same frames?")
    frames = np.full((len(clouds), most, 3), np.nan)
    for frame, cloud in zip(frames, clouds):
        frame[:len(cloud)] = cloud
    return frames


def clouds_of_view(view, options):
    masks, folder, camera_file = view
    camera = Camera(camera_file)
    masks, images = list(images_in(masks, None)), list(images_in(folder, options.depth_unit))
    if len(masks) != len(images) or masks[0].shape != images[0].shape:
        raise Error(f"{view[0]}: has {len(masks)} masks of {masks[0].shape}, but {folder} "
                         f"{len(images)} depth images of {images[0].shape}")
    return padded([cloud_of(camera, image, mask > 0, options.most)
                   for mask, image in zip(masks, images)])


def clouds_of_folder(options):
    folder = pathlib.Path(options.folder)
    files = files_in(folder, ".npy", ".ply", ".pcd")
    if len(files) < 2:
        raise Error(f"{folder}: has {len(files)} clouds (.npy, .ply, .pcd), expected 2 or more")
    return padded([thinned(read_cloud(path), options.most) for path in files])


def markers_of_c3d(options):
    """Points and controllers (T, n, 3), m, and the frame rate."""
    try:
        import ezc3d
    except ImportError:
        raise Error("c3d needs ezc3d (pip install ezc3d)") from None
    try:
        take = ezc3d.c3d(options.file)
    except (OSError, RuntimeError, ValueError) as error:
        raise Error(f"{options.file}: cannot be read: {error}") from None
    group = take["parameters"]["POINT"]
    labels = [str(label).strip() for label in group["LABELS"]["value"]]
    unit = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}.get((group["UNITS"]["value"] or ["mm"])[0].strip())
    if unit is None:
        raise Error(f"{options.file}: has the units {group['UNITS']['value']}, expected mm, "
                         "cm or m")
    places = unit * np.transpose(take["data"]["points"][:3], (2, 1, 0))
    places[~np.isfinite(places).all(axis=2)] = np.nan
    held = list(dict.fromkeys(name for name in (options.held or "").split(",") if name))
    for name in held:
        if name not in labels:
            raise Error(f"{options.file}: has no marker {name}, but {', '.join(labels)}")
    hands = [labels.index(name) for name in held]
    others = [i for i in range(places.shape[1]) if i not in hands]
    return places[:, others], places[:, hands], float(group["RATE"]["value"][0])


def filled_in(path):
    """Controllers must be known in all frames: gaps are filled along straight lines."""
    frames = np.arange(len(path))
    gaps = np.flatnonzero(~np.isfinite(path).all(axis=(1, 2)))
    if len(gaps) > 0 and path.shape[1] > 0:
        print(f"sensors_to_npz: warning: controllers are not known in {len(gaps)} of {len(path)} "
              "frames: they are taken to move straight there", file=sys.stderr)
    for place in path.reshape(len(path), -1).T:
        known = np.isfinite(place)
        if not known.any():
            raise Error("a controller is not seen in any frame")
        place[~known] = np.interp(frames[~known], frames[known], place[known])
    return path


def controllers_of(options, frames):
    if options.controllers is None:
        print("sensors_to_npz: warning: no --controllers: nothing holds the object",
              file=sys.stderr)
        return np.zeros((frames, 0, 3))
    path = array_of_npz(options.controllers, ["controllers"], "controllers").astype(float)
    if path.ndim == 2:
        path = path[:, None]
    if path.ndim != 3 or path.shape[2] != 3 or len(path) != frames:
        raise Error(f"{options.controllers}: has the shape {path.shape}, expected "
                         f"({frames}, C, 3)")
    return path


def recording_of(options):
    arrays = {}
    if options.kind != "c3d" and not options.fps:  # before the files, which take time
        raise Error("--fps is needed")
    if options.kind == "c3d":
        arrays["points"], controllers, rate = markers_of_c3d(options)
        options.fps = options.fps or rate
        if not options.fps:
            raise Error(f"{options.file}: has no frame rate; --fps is needed")
        if options.held and options.controllers:
            raise Error("--held and --controllers exclude each other")
        if not options.held:
            controllers = controllers_of(options, len(arrays["points"]))
    elif options.kind == "tracks":
        views = [points_of_view(view, options) for view in options.view]
        arrays["points"] = joined_frames(views, "track")
    elif options.kind == "depth":
        arrays["surface"] = joined_frames([clouds_of_view(v, options) for v in options.view],
                                          "depth")
    else:
        arrays["surface"] = clouds_of_folder(options)
    measured = next(iter(arrays.values()))
    if options.kind != "c3d":
        controllers = controllers_of(options, len(measured))
    arrays["controllers"] = filled_in(controllers)
    if "points" in arrays:  # what no frame shows is no point
        ever = np.isfinite(arrays["points"]).all(axis=2).any(axis=0)
        arrays["points"] = arrays["points"][:, ever]
        if not ever.any():
            raise Error("no point is visible with a depth in any frame: are tracks, depth and "
                             "camera of the same pictures?")
    if options.up == "y":
        arrays = {name: np.stack([p[..., 0], -p[..., 2], p[..., 1]], axis=-1)
                  for name, p in arrays.items()}
    arrays = {name: positions.astype(np.float32) for name, positions in arrays.items()}
    arrays["fps"] = np.float64(options.fps)
    if options.ground is not None:
        arrays["ground"] = np.array([0, 0, 1, options.ground])
    if options.mass:
        arrays["mass"] = np.float64(options.mass)
    return arrays


def positive(text):
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError("must be positive and finite")
    return value


def whole(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError("must be 1 or more")
    return value


def parse(arguments):
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument("-o", "--output", required=True, type=pathlib.Path, metavar="REC.npz")
    common.add_argument("--controllers", metavar="FILE",
                        help="where what holds the object is, m: (T, C, 3) in a .npy, or array "
                             "'controllers' of a .npz")
    common.add_argument("--fps", type=positive, help="frames a second")
    common.add_argument("--mass", type=positive, help="of the object, kg")
    common.add_argument("--ground", type=float, metavar="HEIGHT",
                        help="of the table or floor that the object touches, m, along the axis that "
                             "points up (default: there is none)")
    common.add_argument("--up", choices=["z", "y"], default="z", help="the axis that points up")
    common.add_argument("--force", action="store_true", help="overwrite a file")
    depth = argparse.ArgumentParser(add_help=False)
    depth.add_argument("--depth-unit", type=positive, default=1e-3, metavar="METRES",
                       help="of the numbers in depth images (default: 0.001, millimetres)")
    most = argparse.ArgumentParser(add_help=False)
    most.add_argument("--most", type=whole, default=400,
                      help="points of a frame of a view (default: 400)")
    parser = argparse.ArgumentParser(prog="sensors_to_npz", description=__doc__, epilog=EXAMPLES,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(dest="kind", required=True)
    view = {"action": "append", "nargs": 3, "required": True}
    kinds.add_parser("tracks", parents=[common, depth], help="2-D tracks with depth").add_argument(
        "--view", metavar=("TRACKS", "DEPTH_DIR", "CAMERA.json"), **view)
    kinds.add_parser("depth", parents=[common, depth, most], help="masks with depth").add_argument(
        "--view", metavar=("MASK_DIR", "DEPTH_DIR", "CAMERA.json"), **view)
    kinds.add_parser("clouds", parents=[common, most], help="a folder of clouds").add_argument(
        "folder")
    c3d = kinds.add_parser("c3d", parents=[common], help="motion capture")
    c3d.add_argument("file")
    c3d.add_argument("--held", metavar="NAME,...", help="markers that are controllers")
    return parser.parse_args(arguments)


def main(arguments=None):
    options = parse(arguments)
    try:
        if options.output.exists() and not options.force:
            raise Error(f"{options.output}: is there already; --force overwrites it")
        arrays = recording_of(options)
        write_files({options.output: npz_bytes(arrays)})
    except Error as error:
        sys.exit(f"sensors_to_npz: error: {error}")
    shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items()
                       if array.ndim == 3)
    print(f"{options.output}: {shapes}, {arrays['fps']:g} frames a second")
    if "surface" in arrays:
        print(f"next: physpring register {options.output} -o NAME.npz")


if __name__ == "__main__":
    main()
