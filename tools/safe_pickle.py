# SPDX-License-Identifier: Apache-2.0
"""Reads pickled numpy arrays and torch checkpoints without running what they name.

A pickle is a program: `pickle.load` calls any function the file names. Here a pickle can only
build plain values (dict, list, tuple, str, bytes, numbers) and numeric arrays: the dozen names by
which numpy and torch describe an array stand for the small classes below, every other name is
refused. numpy and torch themselves are never called with unchecked values; torch is not needed.

It reads what torch >= 1.6 writes (a zip of data.pkl and one member a storage), not the older
format, not sparse or quantised tensors.
"""

import collections
import pickle
import zipfile

import numpy as np

_LEGACY_TORCH = pickle.dumps(0x1950A86A20F9469CFC6C, protocol=2)  # how the old format begins


class Error(Exception):
    """Bad input, in one line."""


class Array:
    """A pickled array; `numpy()` checks it and gives the real one."""

    def __init__(self, dtype=None, shape=(), data=b"", fortran=False):
        self.dtype, self.shape, self.data, self.fortran = dtype, shape, data, fortran

    def __setstate__(self, state):
        _, self.shape, self.dtype, self.fortran, self.data = state

    def numpy(self):
        if not isinstance(self.dtype, _Dtype):
            raise Error("has an array that is not plain numbers in C order")
        dtype = self.dtype.numpy()
        if not isinstance(self.shape, tuple) or not all(
                isinstance(n, int) and n >= 0 for n in self.shape):
            raise Error(f"has an array of shape {self.shape!r}")
        size = dtype.itemsize
        for n in self.shape:
            size *= n
        if not isinstance(self.data, (bytes, bytearray)) or len(self.data) != size:
            raise Error(f"has an array whose bytes do not fill its shape {self.shape}")
        order = "F" if self.fortran else "C"
        try:
            return np.frombuffer(self.data, dtype).reshape(self.shape, order=order).copy()
        except (OverflowError, ValueError):  # too many dimensions, or too large beside an empty one
            raise Error(f"has an array of shape {self.shape}") from None


class _Dtype:
    """numpy.dtype: (name) and, by __setstate__, (version, byte order, subarray, names, ...)."""

    def __init__(self, name, *_):
        self.name, self.byte_order = name, "="

    def __setstate__(self, state):
        if any(part is not None for part in state[2:5]):
            raise Error("has an array of records, not of numbers")
        self.byte_order = {"|": "=", "<": "<", ">": ">", "=": "="}[state[1]]

    def numpy(self):
        allowed = ("b1", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f2", "f4", "f8")
        if self.name not in allowed:
            raise Error(f"has an array of type {self.name!r}, not of numbers")
        return np.dtype(self.name).newbyteorder(self.byte_order)


class _Storage:
    """A torch storage: its numpy type (None: not one that numpy has) and its bytes."""

    def __init__(self, dtype, data):
        self.dtype, self.data = dtype, data


def _reconstruct(*_):
    return Array()


def _from_buffer(data, dtype, shape, order, axis_order=None):
    if order not in ("C", "F") or axis_order is not None:
        raise Error("has an array with its axes in another order than C or Fortran")
    return Array(dtype, shape, data, order == "F")


def _scalar(dtype, data):
    return Array(dtype, (), data).numpy()[()]


def _encode(text, encoding):
    if encoding != "latin1":
        raise Error(f"has bytes in the encoding {encoding!r}, not latin1")
    return text.encode("latin1")


def _empty_bytes():
    return b""


def _rebuild_tensor(storage, offset, size, stride, *_):
    contiguous, expected = True, 1
    for n, step in zip(reversed(size), reversed(stride)):
        contiguous = contiguous and (n == 1 or step == expected)
        expected *= n
    if not contiguous or storage.dtype is None:
        return Array()
    item = np.dtype(storage.dtype).itemsize
    data = storage.data[offset * item:(offset + expected) * item]
    return Array(_Dtype(storage.dtype), tuple(size), data)


def _rebuild_parameter(tensor, *_):
    return tensor


_NUMPY_NAMES = {
    ("numpy", "dtype"): _Dtype,
    ("numpy", "ndarray"): Array,
    ("_codecs", "encode"): _encode,  # how protocols 0 to 2 write bytes
    ("__builtin__", "bytes"): _empty_bytes,
    ("collections", "OrderedDict"): collections.OrderedDict,
}
for _core in ("numpy.core", "numpy._core"):  # numpy 1 and 2
    _NUMPY_NAMES[_core + ".multiarray", "_reconstruct"] = _reconstruct
    _NUMPY_NAMES[_core + ".multiarray", "scalar"] = _scalar
    _NUMPY_NAMES[_core + ".numeric", "_frombuffer"] = _from_buffer

_STORAGE_TYPES = {
    "FloatStorage": "f4", "DoubleStorage": "f8", "HalfStorage": "f2", "BFloat16Storage": None,
    "LongStorage": "i8", "IntStorage": "i4", "ShortStorage": "i2", "CharStorage": "i1",
    "ByteStorage": "u1", "BoolStorage": "b1",
}

_TORCH_NAMES = dict(_NUMPY_NAMES)
_TORCH_NAMES["torch._utils", "_rebuild_tensor_v2"] = _rebuild_tensor
_TORCH_NAMES["torch._utils", "_rebuild_parameter"] = _rebuild_parameter
for _name in _STORAGE_TYPES:
    _TORCH_NAMES["torch", _name] = _name


class _Unpickler(pickle.Unpickler):
    def __init__(self, file, names, storage=None):
        super().__init__(file)
        self._names, self._storage = names, storage

    def find_class(self, module, name):
        if (module, name) not in self._names:
            raise Error(f"names {module}.{name}, which is not data: refused")
        return self._names[module, name]

    def persistent_load(self, pid):
        if self._storage is None:
            raise Error("refers to data outside the file")
        return self._storage(*pid)


def _load(unpickler, path):
    try:
        return unpickler.load()
    except Error as error:
        raise Error(f"{path}: {error}") from None
    except Exception as error:  # a damaged pickle can raise anything
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise Error(f"{path}: not a whole pickle: {reason}") from None


def read_pickle(path):
    """The value pickled in `path`; arrays in it are `Array`s."""
    try:
        with open(path, "rb") as file:
            return _load(_Unpickler(file, _NUMPY_NAMES), path)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None


def read_torch(path):
    """The value saved by torch.save in `path`; tensors in it are `Array`s."""
    try:
        with open(path, "rb") as file:
            if file.read(len(_LEGACY_TORCH)) == _LEGACY_TORCH:
                raise Error(f"{path}: torch's format of before version 1.6; write it again with "
                            "torch.save(torch.load(FILE), FILE) of a newer torch")
        with zipfile.ZipFile(path) as archive:
            return _read_torch_archive(archive, path)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    except zipfile.BadZipFile as error:
        raise Error(f"{path}: not a whole torch checkpoint: {error}") from None


def _read_torch_archive(archive, path):
    names = archive.namelist()
    pickles = [name for name in names if name == "data.pkl" or name.endswith("/data.pkl")]
    if len(pickles) != 1:
        raise Error(f"{path}: not a torch checkpoint: {len(pickles)} members data.pkl, not one")
    folder = pickles[0][:-len("data.pkl")]
    if folder + "byteorder" in names and archive.read(folder + "byteorder") != b"little":
        raise Error(f"{path}: byte order is not little endian")

    def storage(kind, storage_type, key, _device, count):
        dtype = _STORAGE_TYPES.get(storage_type)
        if kind != "storage" or dtype is None:
            return _Storage(None, b"")
        member = f"{folder}data/{key}"
        size = np.dtype(dtype).itemsize * count
        if member not in names or archive.getinfo(member).file_size != size:
            raise Error(f"storage {key} of {count} {dtype} is not whole")
        return _Storage(dtype, archive.read(member))

    with archive.open(pickles[0]) as file:
        return _load(_Unpickler(file, _TORCH_NAMES, storage), path)
