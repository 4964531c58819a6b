# SPDX-License-Identifier: Apache-2.0
"""Makes PhysTwin cases for tests: the files as PhysTwin and torch write them, without torch."""

import collections
import io
import json
import os
import pickle
import sys
import types
import unittest.mock
import zipfile

import numpy as np

PARAMETERS = {
    "global_spring_Y": 30000.0, "object_radius": 0.03, "object_max_neighbours": 12,
    "controller_radius": 0.05, "controller_max_neighbours": 8, "collide_elas": np.float32(0.25),
    "collide_fric": np.float64(0.75), "collide_object_elas": 0.5, "collide_object_fric": 1.25,
    "collision_dist": 0.02, "drag_damping": 3.75, "dashpot_damping": np.float32(80.5),
}


def final_data(frames=6, points=40, surface=12, interior=9, controllers=3, seed=1):
    """A cloud that sinks and drifts, 2 to 10 cm above the ground; z points down."""
    random = np.random.default_rng(seed)
    low, high = np.array([0.0, 0.0, -0.1]), np.array([0.08, 0.06, -0.02])

    def cloud(count):
        return random.uniform(low, high, (count, 3))

    drift = np.arange(frames)[:, None, None] * np.array([0.002, -0.001, 0.001])
    visible = random.random((frames, points)) < 0.8
    visible[0] = True
    motion_valid = np.zeros_like(visible)
    motion_valid[:-1] = visible[:-1] & visible[1:] & (random.random((frames - 1, points)) < 0.9)
    object_points = (cloud(points) + drift).astype(np.float32)
    object_points[~visible] = 0
    return {
        "object_points": object_points,
        "object_colors": np.ones((frames, points, 3)),
        "object_visibilities": visible,
        "object_motions_valid": motion_valid,
        "controller_points": cloud(controllers) + drift,
        "controller_mask": np.ones(controllers, bool),
        "surface_points": cloud(surface),
        "interior_points": cloud(interior),
    }


def write_pickle(path, value, protocol=4):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(pickle.dumps(value, protocol))


def write_case(folder, data, split=(0, 4), track=None):
    write_pickle(folder / "final_data.pkl", data)
    if split is not None:
        frames = len(data["object_points"])
        text = json.dumps({"frame_len": frames, "train": split, "test": [split[1], frames]})
        (folder / "split.json").write_text(text)
    if track is not None:
        write_pickle(folder / "gt_track_3d.pkl", track)


class _Storage:
    def __init__(self, array):
        self.array = array


def _rebuild_tensor_v2():
    pass


class Tensor:
    """A float32 array that is pickled as torch pickles a tensor."""

    def __init__(self, values):
        self.array = np.asarray(values, np.float32)

    def __reduce__(self):
        stride = tuple(step // 4 for step in self.array.strides)
        return _rebuild_tensor_v2, (_Storage(self.array), 0, self.array.shape, stride, False,
                                    collections.OrderedDict())


def _fake_torch():
    modules = {"torch": types.ModuleType("torch"), "torch._utils": types.ModuleType("torch._utils")}
    modules["torch"].FloatStorage = type("FloatStorage", (), {"__module__": "torch"})
    _rebuild_tensor_v2.__module__ = "torch._utils"
    modules["torch._utils"]._rebuild_tensor_v2 = _rebuild_tensor_v2
    return modules


def torch_save(value, path):
    """Writes `value` as torch.save does: a zip of data.pkl and one member a storage."""
    modules, storages = _fake_torch(), []

    class Pickler(pickle.Pickler):
        def persistent_id(self, obj):
            if not isinstance(obj, _Storage):
                return None
            storages.append(obj.array.tobytes())
            key = str(len(storages) - 1)
            return "storage", modules["torch"].FloatStorage, key, "cuda:0", obj.array.size

    buffer = io.BytesIO()
    with unittest.mock.patch.dict(sys.modules, modules):
        Pickler(buffer, 2).dump(value)
    path.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{path.stem}/data.pkl", buffer.getvalue())
        archive.writestr(f"{path.stem}/byteorder", "little")
        for key, data in enumerate(storages):
            archive.writestr(f"{path.stem}/data/{key}", data)
        archive.writestr(f"{path.stem}/version", "3\n")


def checkpoint(spring_Y, object_springs):
    return {
        "epoch": 180, "num_object_springs": object_springs, "spring_Y": Tensor(spring_Y),
        "collide_elas": Tensor([1.5]), "collide_fric": Tensor([0.5]),
        "collide_object_elas": Tensor([0.75]), "collide_object_fric": Tensor([-0.25]),
        "optimizer_state_dict": {
            "state": {0: {"step": Tensor(7.0), "exp_avg": Tensor(spring_Y)}},
            "param_groups": [{"lr": 1e-3, "betas": (0.9, 0.99), "foreach": None, "params": [0]}],
        },
    }


class Command:
    """Pickles as a call that makes a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)
