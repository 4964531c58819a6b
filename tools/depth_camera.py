# SPDX-License-Identifier: Apache-2.0
"""Pinhole cameras that measure depth: from pixels to places in the world. Imported by
sensors_to_npz.py. Pixel (u, v) at depth z, in metres along the optical axis, is at
    x = (u - cx) z / fx,   y = (v - cy) z / fy,   z
in the camera's frame (x to the right, y down, z forward, as OpenCV has it)."""

import json

import numpy as np

from safe_pickle import Error

KEYS = ("fx", "fy", "cx", "cy")
JUMP = 0.02  # of the depth, from one pixel to the next: an edge


class Camera:
    """fx, fy, cx, cy in pixels; camera_to_world: (4, 4), rotation and place in metres."""

    def __init__(self, path):
        try:
            with open(path, encoding="utf-8") as file:
                text = json.load(file)
            self.fx, self.fy, self.cx, self.cy = (float(text[key]) for key in KEYS)
            pose = np.array(text["camera_to_world"], float)
        except KeyError as error:
            raise Error(f"{path}: has no {error.args[0]}, expected the numbers {', '.join(KEYS)} and "
                        "camera_to_world, 4 rows of 4") from None
        except (OSError, ValueError, TypeError, OverflowError, RecursionError) as error:
            raise Error(f"{path}: expected JSON with the numbers {', '.join(KEYS)} and "
                             f"camera_to_world, 4 rows of 4: {error}") from None
        if pose.shape != (4, 4) or not np.isfinite(pose).all() or list(pose[3]) != [0, 0, 0, 1]:
            raise Error(f"{path}: camera_to_world has the shape {pose.shape}, expected (4, 4) "
                             "finite numbers, the last row 0 0 0 1")
        turn = pose[:3, :3]
        if not np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) or np.linalg.det(turn) < 0:
            raise Error(f"{path}: camera_to_world does not begin with a rotation")
        if not (0 < self.fx < 1e6 and 0 < self.fy < 1e6 and np.isfinite([self.cx, self.cy]).all()):
            raise Error(f"{path}: fx and fy must be positive, cx and cy finite, in pixels")
        self.turn, self.place = turn, pose[:3, 3]

    def to_world(self, pixels, depth):
        """pixels: (..., 2) as (u, v); depth: (...), m. Returns (..., 3); NaN where depth is."""
        u, v = pixels[..., 0], pixels[..., 1]
        own = np.stack([(u - self.cx) / self.fx * depth, (v - self.cy) / self.fy * depth, depth],
                       axis=-1)
        return own @ self.turn.T + self.place


def depth_at(image, pixels):
    """Depth of what is seen at (u, v), (N, 2); NaN outside of the image, or where it is 0. It is the
    nearest pixel's. At an edge, where depth jumps among the 3 x 3 pixels around, it is the median
    of the near side: the pixel may show what is behind, but a point that is seen is in front."""
    height, width = image.shape
    column, row = np.rint(pixels[:, 0]), np.rint(pixels[:, 1])
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    column = np.where(inside, column, 0).astype(int)
    row = np.where(inside, row, 0).astype(int)
    around = np.array([image[np.clip(row + i, 0, height - 1), np.clip(column + j, 0, width - 1)]
                       for i in (-1, 0, 1) for j in (-1, 0, 1)], float)
    around = np.where((around > 0) & np.isfinite(around), around, np.nan)
    depth = around[4]
    rising = np.sort(around, axis=0)  # NaN last
    rise = np.nan_to_num(np.diff(rising, axis=0), nan=0)
    last = rise.argmax(axis=0)
    jumps = rise.max(axis=0) > JUMP * np.nan_to_num(rising[0], nan=np.inf)
    near = np.take_along_axis(rising, last[None] // 2, axis=0)[0]
    return np.where(inside, np.where(jumps, near, depth), np.nan)


def thinned(points, most):
    """At most `most` of the rows, evenly."""
    if len(points) <= most:
        return points
    return points[np.linspace(0, len(points) - 1, most).astype(int)]


def cloud_of(camera, image, mask, most):
    """All pixels of the mask that have a depth, at most `most` of them, evenly: (S, 3)."""
    rows, columns = thinned(np.argwhere(mask & (image > 0) & np.isfinite(image)), most).T
    pixels = np.stack([columns, rows], axis=-1).astype(float)
    return camera.to_world(pixels, image[rows, columns])
