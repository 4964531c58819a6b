# SPDX-License-Identifier: Apache-2.0
"""Arrays, folders of images and 2-D tracks from files. Imported by sensors_to_npz.py."""

import decimal
import pathlib
import re
import zipfile
import zlib

import numpy as np

from safe_pickle import Error


def load_array(path, what):
    try:
        loaded = np.load(path, allow_pickle=False)
        if not isinstance(loaded, np.ndarray):
            loaded = {name: loaded[name] for name in loaded.files}
    except (OSError, ValueError, EOFError, MemoryError, zipfile.BadZipFile, zlib.error) as error:
        raise Error(f"{path}: cannot be read as {what}: {str(error)[:200]}") from None
    for array in loaded.values() if isinstance(loaded, dict) else [loaded]:
        if array.dtype.kind not in "buif":
            raise Error(f"{path}: has the type {array.dtype}, expected real numbers ({what})")
    return loaded


def array_of_npz(path, names, what):
    """The first array of those names; the only one of a .npy."""
    loaded = load_array(path, what)
    if isinstance(loaded, np.ndarray):
        return loaded
    for name in names:
        if name in loaded:
            return loaded[name]
    raise Error(f"{path}: has none of the arrays {', '.join(names)} ({what}), but "
                     f"{', '.join(loaded)}")


def files_in(folder, *endings):
    """Files of a folder with these endings, in the order of their names, in which numbers are numbers:
    9.npy comes before 10.npy, and 1.02.npy before 1.1.npy."""
    def place(path):
        parts = re.split(r"([0-9]+(?:\.[0-9]+)?)", path.stem)  # every other one is a number
        return [(part, 0) if i % 2 == 0 else ("", decimal.Decimal(part))
                for i, part in enumerate(parts)], path.name
    return sorted((path for path in pathlib.Path(folder).glob("*")
                   if path.suffix.lower() in endings), key=place)


def images_in(folder, unit):
    """The images of a folder in the order of their names: .npy, or .png if there is Pillow."""
    folder = pathlib.Path(folder)
    files = files_in(folder, ".npy", ".png")
    shape = None
    if not files:
        raise Error(f"{folder}: has no images *.npy or *.png")
    for path in files:
        if path.suffix.lower() == ".npy":
            image = load_array(path, "an image")
        else:
            try:
                from PIL import Image
                image = np.asarray(Image.open(path))
            except ImportError:
                raise Error(f"{path}: needs Pillow (pip install pillow)") from None
            except (OSError, ValueError, SyntaxError) as error:
                raise Error(f"{path}: cannot be read: {error}") from None
        if image.ndim == 3 and unit is None:  # a mask in colours
            image = image.max(axis=2)
        if image.ndim != 2:
            raise Error(f"{path}: has the shape {image.shape}, expected (height, width)")
        shape = shape or image.shape
        if image.shape != shape:
            raise Error(f"{path}: has the shape {image.shape}, but {files[0].name} {shape}")
        yield image if unit is None else image * unit


def read_tracks(path):
    """Pixels (T, N, 2), NaN where a point is not visible. CoTracker writes (1, T, N, 2) and
    visibility (1, T, N); TAPIR (N, T, 2) and occluded (N, T)."""
    loaded = load_array(path, "tracks")
    if isinstance(loaded, np.ndarray):
        loaded = {"tracks": loaded}
    tracks = np.array(loaded["tracks"], float) if "tracks" in loaded else None
    if tracks is None:
        raise Error(f"{path}: has no array 'tracks'")
    seen = np.array(loaded["visibility"]) > 0.5 if "visibility" in loaded else None
    if "occluded" in loaded and tracks.ndim >= 3 and np.ndim(loaded["occluded"]) >= 2:
        tracks, seen = np.swapaxes(tracks, -3, -2), ~np.swapaxes(
            np.array(loaded["occluded"]) > 0.5, -2, -1)
    if tracks.ndim < 3:
        raise Error(f"{path}: array 'tracks' has the shape {tracks.shape}, expected (T, N, 2)")
    while tracks.ndim > 3 and tracks.shape[0] == 1:
        tracks = tracks[0]
    if tracks.ndim != 3 or tracks.shape[2] != 2:
        raise Error(f"{path}: array 'tracks' has the shape {tracks.shape}, expected (T, N, 2)")
    if seen is not None:
        seen = seen.reshape(seen.shape[-2:]) if seen.size == tracks.size // 2 else None
        if seen is None or seen.shape != tracks.shape[:2]:
            raise Error(f"{path}: visibility does not have a value for each of the "
                             f"{tracks.shape[0]} x {tracks.shape[1]} track points")
        tracks[~seen] = np.nan
    return tracks
