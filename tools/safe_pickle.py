# SPDX-License-Identifier: Apache-2.0
"""Reads pickled numpy arrays and torch checkpoints without running what they name.

A pickle is a program: `pickle.load` calls any function the file names. Here a pickle can only
build plain values (dict, list, tuple, str, bytes, numbers) and numeric arrays: pickle_machine.py
runs it, the dozen names by which numpy and torch describe an array stand for the small classes
below, every other name is refused. numpy and torch themselves are never called with unchecked
values; torch is not needed. Whatever is in a file, reading it ends with its value or with an
`Error` of one line, and takes a few times its size of memory.

It reads what torch >= 1.6 writes (a zip of data.pkl and one member a storage), not the older
format, not sparse or quantised tensors.
"""

import collections
import io
import os
import pickle
import stat
import struct
import zipfile
import zlib

import numpy as np

from pickle_machine import Error, Machine, shown

MOST_DIMENSIONS = 64
MOST_DIRECTORY = 1 << 20  # bytes of a zip's table of contents
_LEGACY_TORCH = pickle.dumps(0x1950A86A20F9469CFC6C, protocol=2)  # how the old format begins


class Array:
    """A pickled array; `numpy()` checks it and gives the real one, which cannot be written to."""

    def __init__(self, dtype=None, shape=(), data=b"", fortran=False):
        self.dtype, self.shape, self.data, self.fortran = dtype, shape, data, fortran

    def __setstate__(self, state):
        _, self.shape, self.dtype, self.fortran, self.data = state

    def numpy(self):
        if not isinstance(self.dtype, _Dtype):
            raise Error("has an array that is not plain numbers in C order")
        dtype = self.dtype.numpy()
        if not _are_extents(self.shape):
            raise Error(f"has an array of shape {shown(self.shape)}")
        size = dtype.itemsize
        for n in self.shape:
            size *= n
        if not isinstance(self.data, (bytes, memoryview)) or len(self.data) != size:
            raise Error(f"has an array whose bytes do not fill its shape {shown(self.shape)}")
        order = "F" if self.fortran else "C"
        try:
            return np.frombuffer(self.data, dtype).reshape(self.shape, order=order)
        except (OverflowError, ValueError):  # too many dimensions, or too large beside an empty one
            raise Error(f"has an array of shape {shown(self.shape)}") from None


def _are_extents(shape):
    return isinstance(shape, tuple) and len(shape) <= MOST_DIMENSIONS and all(
        isinstance(n, int) and 0 <= n < 1 << 63 for n in shape)


class _Dtype:
    """numpy.dtype: (name) and, by __setstate__, (version, byte order, subarray, names, ...)."""

    def __init__(self, name, *_):
        self.name, self.byte_order = name, "="

    def __setstate__(self, state):
        if any(part is not None for part in state[2:5]):
            raise Error("has an array of records, not of numbers")
        if not isinstance(state[1], str) or state[1] not in ("|", "<", ">", "="):
            raise Error(f"has an array in the byte order {shown(state[1])}")
        self.byte_order = "=" if state[1] == "|" else state[1]

    def numpy(self):
        allowed = ("b1", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f2", "f4", "f8")
        if not isinstance(self.name, str) or self.name not in allowed:
            raise Error(f"has an array of type {shown(self.name)}, not of numbers")
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
        raise Error(f"has bytes in the encoding {shown(encoding)}, not latin1")
    return text.encode("latin1")


def _empty_bytes():
    return b""


def _ordered_dict():
    return collections.OrderedDict()


def _rebuild_tensor(storage, offset, size, stride, *_):
    if not isinstance(storage, _Storage) or not _are_extents((offset,)) or not (
            _are_extents(size) and _are_extents(stride) and len(size) == len(stride)):
        raise Error("has a tensor whose shape is none")
    contiguous, expected = True, 1
    for n, step in zip(reversed(size), reversed(stride)):
        contiguous = contiguous and (n == 1 or step == expected)
        expected *= n
    if not contiguous or storage.dtype is None:
        return Array()
    item = np.dtype(storage.dtype).itemsize
    data = storage.data[offset * item:(offset + expected) * item]
    return Array(_Dtype(storage.dtype), size, data)


def _rebuild_parameter(tensor, *_):
    return tensor


_NUMPY_NAMES = {
    ("numpy", "dtype"): _Dtype,
    ("numpy", "ndarray"): Array,
    ("_codecs", "encode"): _encode,  # how protocols 0 to 2 write bytes
    ("__builtin__", "bytes"): _empty_bytes,
    ("collections", "OrderedDict"): _ordered_dict,
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


def _load(machine, path):
    try:
        return machine.load()
    except Error as error:
        raise Error(f"{path}: {error}") from None
    except MemoryError:
        raise Error(f"{path}: needs more memory than there is") from None
    except Exception as error:  # a damaged pickle can raise anything
        reason = f"{type(error).__name__}: {shown(str(error))}"
        raise Error(f"{path}: not a whole pickle: {reason}") from None


def _read(path):
    try:
        with open(path, "rb") as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):  # which may never end
                raise Error(f"{path}: is no file")
            return file.read()
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    except MemoryError:
        raise Error(f"{path}: needs more memory than there is") from None


def read_pickle(path):
    """The value pickled in `path`; arrays in it are `Array`s, bytes are memoryviews."""
    return _load(Machine(_read(path), _NUMPY_NAMES), path)


def read_torch(path):
    """The value saved by torch.save in `path`; tensors in it are `Array`s."""
    data = _read(path)
    if data.startswith(_LEGACY_TORCH):
        raise Error(f"{path}: torch's format of before version 1.6; write it again with "
                    "torch.save(torch.load(FILE), FILE) of a newer torch")
    try:
        archive = _Archive(data)
    except Error as error:
        raise Error(f"{path}: {error}") from None
    except MemoryError:
        raise Error(f"{path}: needs more memory than there is") from None
    except Exception as error:  # zipfile raises half a dozen types
        raise Error(f"{path}: not a whole torch checkpoint: {shown(str(error))}") from None
    return _load(Machine(archive.pickle, _TORCH_NAMES, archive.storage), path)


class _Directory(io.BytesIO):
    """A zip of which only a table of contents of moderate length is read."""

    def read(self, size=-1):
        if size > MOST_DIRECTORY:
            raise Error(f"the zip's table of contents has {size} bytes")
        return super().read(size)


class _Archive:
    """The members of a torch checkpoint."""

    def __init__(self, data):
        self._data, self._storages = data, {}
        self._left = len(data)  # bytes of members to read: they do not overlap
        with zipfile.ZipFile(_Directory(data)) as archive:
            self._infos = {info.filename: info for info in archive.infolist()}
        found = [name for name in self._infos if name == "data.pkl" or name.endswith("/data.pkl")]
        if len(found) != 1:
            raise Error(f"not a torch checkpoint: {len(found)} members data.pkl, not one")
        self._folder = found[0][:-len("data.pkl")]
        self.pickle = bytes(self._member("data.pkl"))
        if (self._folder + "byteorder" in self._infos and
                bytes(self._member("byteorder")[:7]) != b"little"):
            raise Error("byte order is not little endian")

    def _member(self, name):
        """The bytes of a member, which torch.save never packs."""
        info = self._infos.get(self._folder + name)
        if info is None:
            raise Error(f"has no member {shown(name)}")
        if info.flag_bits & 1 or info.compress_type != zipfile.ZIP_STORED:
            raise Error(f"member {shown(name)} is encrypted or packed, which torch.save never does")
        at = info.header_offset
        header = self._data[at:at + 30]
        if len(header) != 30 or not header.startswith(b"PK\3\4"):
            raise Error(f"member {shown(name)} has no header")
        at += 30 + sum(struct.unpack("<HH", header[26:]))
        content = memoryview(self._data)[at:at + info.file_size]
        self._left -= info.file_size
        if len(content) != info.file_size or self._left < 0 or zlib.crc32(content) != info.CRC:
            raise Error(f"member {shown(name)} is not whole")
        return content

    def storage(self, kind, storage_type, key, _device, count):
        """What a torch pickle's persistent id stands for."""
        if not all(isinstance(text, str) for text in (kind, storage_type, key)):
            raise Error("refers to data outside the file")
        dtype = _STORAGE_TYPES.get(storage_type)
        if kind != "storage" or dtype is None or not isinstance(count, int):
            return _Storage(None, b"")
        if key not in self._storages:
            self._storages[key] = self._member(f"data/{key}")
        if len(self._storages[key]) != np.dtype(dtype).itemsize * count:
            raise Error(f"storage {shown(key)} of {shown(count)} {dtype} is not whole")
        return _Storage(dtype, self._storages[key])
