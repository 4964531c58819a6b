# SPDX-License-Identifier: Apache-2.0
"""Reads what PhysTwin keeps of a case: its data, its parameters and its checkpoint.

Ours has z up; where z points down in a case, (x, y, z) -> (x, -y, -z), a half turn about x. Points
that are not visible are stored as zeros; here they are NaN. docs/phystwin.md describes the files.
"""

import collections
import numbers

import numpy as np

import safe_pickle
from phystwin_settings import read_json
from pickle_machine import shown
from safe_pickle import Error

MOST_COORDINATE = 1000.0  # m
MOST_NEIGHBOURS = 1000  # PhysTwin's are 10 to 80
MOST_PARAMETER = 1e9  # of any unit; PhysTwin's Y, its largest, is up to 1e5

Case = collections.namedtuple("Case", [
    "points",  # (T, N, 3) float32, m, z up; NaN: not seen, or its motion to here is not valid
    "surface",  # (T, N, 3) the same, NaN only where not seen
    "controllers",  # (T, C, 3)
    "interior",  # (M, 3): PhysTwin's surface points, then its interior points
    "tracked",  # (N, 3): the N tracked points in frame 0 as PhysTwin takes them, seen or not
    "track",  # (T, K, 3) key points or None
    "train_frames",  # or None
    "reverse_z",  # whether z points down in the case's files
])


def array_of(data, key, shape, path):
    """data[key] as float32 of `shape`, whose negative extents may be anything."""
    value = data.get(key)
    if not isinstance(value, safe_pickle.Array):
        raise Error(f"{path}: no array {key}")
    try:
        array = value.numpy()
    except Error as error:
        raise Error(f"{path}: {key}: {error}") from None
    if array.ndim != len(shape) or any(want not in (-1, n) for want, n in zip(shape, array.shape)):
        expected = tuple("any" if n == -1 else n for n in shape)
        raise Error(f"{path}: {key} has shape {array.shape}, expected {expected}")
    with np.errstate(over="ignore"):  # what is too large becomes infinite and is refused as that
        return array.astype(np.float32)


def mask_of(data, key, shape, path):
    mask = array_of(data, key, shape, path)
    if not np.isin(mask, (0, 1)).all():
        raise Error(f"{path}: {key} has values other than 0 and 1")
    return mask == 1


def require_finite(array, key, path):
    if not np.isfinite(array).all():
        raise Error(f"{path}: {key} has values that are not finite")


def require_places(array, key, path):
    require_finite(array, key, path)
    if array.size > 0 and np.abs(array).max() > MOST_COORDINATE:
        raise Error(f"{path}: {key} has a coordinate of {np.abs(array).max():g} m, expected "
                    f"{MOST_COORDINATE:g} m or less")


def z_up(points, reverse_z):
    if not reverse_z:
        return points
    return points * np.array([1, -1, -1], np.float32) + np.float32(0)  # + 0: no -0


def read_train_frames(path, frames):
    split = read_json(path)
    try:
        start, end = split["train"]
    except (TypeError, KeyError, ValueError):
        raise Error(f"{path}: no \"train\": [0, end]") from None
    if start != 0 or not isinstance(end, int) or not 2 <= end <= frames:
        raise Error(f"{path}: train is [{shown(start)}, {shown(end)}], expected [0, end], "
                    f"2 <= end <= {frames}")
    return end


def read_track(path, frames, reverse_z):
    track = array_of({"track": safe_pickle.read_pickle(path)}, "track", (-1, -1, 3), path)
    if len(track) < frames:
        raise Error(f"{path}: {len(track)} frames, final_data.pkl has {frames}")
    if track.shape[1] < 1:
        raise Error(f"{path}: has no key point")
    require_places(track[~np.isnan(track)], "the track", path)
    track[np.isnan(track).any(axis=2)] = np.nan
    return z_up(track[:frames], reverse_z)


def read_case(folder, reverse_z=None):
    """The case. z points down in it if reverse_z; None: so that most points are above z = 0."""
    path = folder / "final_data.pkl"
    data = safe_pickle.read_pickle(path)
    if not isinstance(data, dict):
        raise Error(f"{path}: holds no dictionary of arrays")
    points = array_of(data, "object_points", (-1, -1, 3), path)
    frames, count = points.shape[:2]
    if frames < 2 or count < 1:
        raise Error(f"{path}: object_points has shape {points.shape}, expected 2 frames or more")
    visible = mask_of(data, "object_visibilities", (frames, count), path)
    motion_valid = mask_of(data, "object_motions_valid", (frames, count), path)
    controllers = np.zeros((frames, 0, 3), np.float32)
    if data.get("controller_points") is not None:
        controllers = array_of(data, "controller_points", (frames, -1, 3), path)
    interior = np.concatenate([array_of(data, key, (-1, 3), path)
                               for key in ("surface_points", "interior_points")])
    require_places(points[visible], "object_points", path)
    require_places(points[0], "object_points of frame 0", path)
    require_places(controllers, "controller_points", path)
    require_places(interior, "surface_points or interior_points", path)

    if reverse_z is None:
        reverse_z = not np.median(points[0, :, 2]) > 0
    points = z_up(points, reverse_z)
    # motion_valid[t] is about the motion from t to t + 1
    followed = visible.copy()
    followed[1:] &= motion_valid[:-1]
    if not followed.any(axis=0).all():
        raise Error(f"{path}: object_points: point {followed.any(axis=0).argmin()} is not seen in "
                    "any frame")
    track_path, split_path = folder / "gt_track_3d.pkl", folder / "split.json"
    return Case(
        points=np.where(followed[:, :, None], points, np.float32(np.nan)),
        surface=np.where(visible[:, :, None], points, np.float32(np.nan)),
        controllers=z_up(controllers, reverse_z),
        interior=z_up(interior, reverse_z),
        tracked=points[0],
        track=read_track(track_path, frames, reverse_z) if track_path.exists() else None,
        train_frames=read_train_frames(split_path, frames) if split_path.exists() else None,
        reverse_z=bool(reverse_z))


def read_parameters(path):
    """PhysTwin's first stage: its 12 numbers by name."""
    data = safe_pickle.read_pickle(path)
    names = ("global_spring_Y", "object_radius", "object_max_neighbours", "controller_radius",
             "controller_max_neighbours", "collide_elas", "collide_fric", "collide_object_elas",
             "collide_object_fric", "collision_dist", "drag_damping", "dashpot_damping")
    parameters = {}
    for name in names:
        try:
            if not isinstance(data[name], numbers.Real):
                raise TypeError
            parameters[name] = float(data[name])
        except (TypeError, KeyError, IndexError, ValueError, OverflowError):
            raise Error(f"{path}: no number {name}") from None
        most = MOST_NEIGHBOURS if name.endswith("neighbours") else MOST_PARAMETER
        if not 0 <= parameters[name] <= most:
            raise Error(f"{path}: {name} is {parameters[name]:g}, expected 0 to {most:g}")
    for name in ("object_max_neighbours", "controller_max_neighbours"):
        parameters[name] = int(parameters[name])
    return parameters


def read_checkpoint(path):
    """PhysTwin's second stage: Y of each spring and the four contact coefficients."""
    data = safe_pickle.read_torch(path)
    if not isinstance(data, dict):
        raise Error(f"{path}: holds no dictionary")
    checkpoint = {"spring_Y": array_of(data, "spring_Y", (-1,), path).astype(np.float64)}
    require_finite(checkpoint["spring_Y"], "spring_Y", path)
    for name in ("collide_elas", "collide_fric", "collide_object_elas", "collide_object_fric"):
        value = array_of(data, name, (1,), path)
        require_finite(value, name, path)
        checkpoint[name] = float(value[0])
    count = data.get("num_object_springs")
    if not isinstance(count, int) or not 0 <= count <= len(checkpoint["spring_Y"]):
        raise Error(f"{path}: num_object_springs is {shown(count)}, expected 0 to "
                    f"{len(checkpoint['spring_Y'])}")
    checkpoint["num_object_springs"] = count  # checked against the springs
    return checkpoint
