# SPDX-License-Identifier: Apache-2.0
"""What the other methods take from a recording, and what a prediction of theirs is."""

import numpy as np
import torch

# more are hardly faster on bodies of this size, and far slower where something else runs
torch.set_num_threads(1)


class Recorded:
    """A recording as tensors. N points, M interior particles, C controllers, T frames."""

    def __init__(self, path, whole=False):
        file = np.load(path)
        tensor = lambda array: torch.tensor(np.asarray(array), dtype=torch.float32)  # noqa: E731
        self.points = tensor(file["points"])  # (T,N,3) m, NaN: not seen
        self.interior = tensor(file["interior"]) if "interior" in file else torch.zeros(0, 3)
        self.controllers = tensor(file["controllers"])  # (T,C,3) m
        self.fps = float(file["fps"])
        self.mass = float(file["mass"]) if "mass" in file else 1.0
        self.gravity = tensor(file["gravity"])
        self.ground = float(file["ground"][3]) if "ground" in file else None  # z, m
        self.frames = len(self.points)
        self.train_frames = (int(file["train_frames"]) if "train_frames" in file
                             else round(0.7 * self.frames))
        if whole:  # all frames are for fitting
            self.train_frames = self.frames

    @property
    def start(self):
        """All particles in frame 0: (N+M,3)."""
        return torch.cat([self.points[0], self.interior])

    def filled(self):
        """The points with gaps in time filled by lines between frames that saw them: (T,N,3)."""
        points = self.points.numpy().copy()
        frames = np.arange(len(points))
        for column in points.transpose(1, 2, 0).reshape(-1, len(points)):
            seen = ~np.isnan(column)
            column[~seen] = np.interp(frames[~seen], frames[seen], column[seen])
        return torch.tensor(points)


def farthest_points(points, radius, most):
    """Numbers of points such that all others are within `radius` of one, at most `most`."""
    chosen = [0]
    distance = (points - points[0]).norm(dim=1)
    while len(chosen) < most and distance.max() > radius:
        chosen.append(int(distance.argmax()))
        distance = torch.minimum(distance, (points - points[chosen[-1]]).norm(dim=1))
    return torch.tensor(chosen)


def carried(start, nodes, moved, neighbours=8):
    """Particles `start` (P,3) carried by the nodes `nodes` (n,3) that moved to `moved` (T,n,3): linear
    blend skinning by turns of the nodes' neighbourhoods, weights 1 / distance. (T,P,3)"""
    neighbours = min(neighbours, len(nodes))
    distance, near = torch.cdist(start, nodes).topk(neighbours, largest=False)
    weight = 1 / (distance + 1e-6)
    weight = weight / weight.sum(1, keepdim=True)
    own = torch.cdist(nodes, nodes).topk(neighbours, largest=False).indices
    before = nodes[own] - nodes[:, None]  # (n,k,3)
    frames = []
    for frame in moved:
        after = frame[own] - frame[:, None]
        turn = rotations(before.transpose(1, 2) @ after)
        offset = start[:, None] - nodes[near]
        placed = frame[near] + (turn[near] @ offset[..., None])[..., 0]
        frames.append((weight[..., None] * placed).sum(1))
    return torch.stack(frames)


def rotations(covariance):
    """The rotations that turn `before` to `after`, of sums before after^T: (n,3,3) (Kabsch)."""
    u, _, vt = torch.linalg.svd(covariance + 1e-12 * torch.eye(3))
    v = vt.transpose(1, 2)
    sign = torch.det(v @ u.transpose(1, 2)).sign()
    v = torch.cat([v[..., :2], v[..., 2:] * sign[:, None, None]], -1)
    return v @ u.transpose(1, 2)
