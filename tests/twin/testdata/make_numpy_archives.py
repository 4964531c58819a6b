# SPDX-License-Identifier: Apache-2.0
"""Writes numpy_stored.npz and numpy_deflated.npz beside this file (numpy 1 or 2)."""
import pathlib

import numpy as np

FOLDER = pathlib.Path(__file__).parent
ARRAYS = {
    "f2": np.array([1.5, -0.25, 65504, 2.0**-24, np.inf, -0.0], np.float16),
    "f4": np.array([[0.1, np.nan, -3]], np.float32),
    "f8": np.array([[[1 / 3]], [[-1e300]]]),
    "i1": np.array([-128, 127], np.int8),
    "i2": np.array([-32768, 32767], np.int16),
    "i4": np.array([-(2**31) + 1, 2**31 - 1], np.int32),
    "i8": np.array([-(2**53), 2**53]),
    "u1": np.frombuffer(b"text", np.uint8),
    "u2": np.array([65535], np.uint16),
    "u4": np.array([2**32 - 1], np.uint32),
    "u8": np.array([2**53], np.uint64),
    "b1": np.array([True, False]),
    "scalar": np.float64(29.97),
    "empty": np.zeros((0, 3)),
    "fortran": np.asfortranarray([1.0, 2.0]),
    "level0/nested": np.int64(7),
}
np.savez(FOLDER / "numpy_stored.npz", **ARRAYS)
np.savez_compressed(FOLDER / "numpy_deflated.npz", **ARRAYS)
