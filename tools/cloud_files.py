# SPDX-License-Identifier: Apache-2.0
"""Point clouds from files: .npy, .ply (Stanford) and .pcd (Point Cloud Library), text or binary in
little endian. Imported by sensors_to_npz.py. Only x, y and z are read."""

import re

import numpy as np

from safe_pickle import Error

MOST_POINTS, MOST_FIELDS = 5_000_000, 100
PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2",
             "int16": "<i2", "ushort": "<u2", "uint16": "<u2", "int": "<i4", "int32": "<i4",
             "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4", "double": "<f8",
             "float64": "<f8"}


def read_cloud(path):
    """(S, 3), m; points that are not finite are left out. Raises Error."""
    readers = {".npy": read_npy, ".ply": read_ply, ".pcd": read_pcd}
    try:
        cloud = np.asarray(readers[path.suffix.lower()](path), float)
    except (OSError, ValueError, TypeError, KeyError, IndexError, MemoryError) as error:
        raise Error(f"{path}: cannot be read as a cloud: {str(error)[:200]}") from None
    if cloud.ndim != 2 or cloud.shape[1] != 3:
        raise Error(f"{path}: has the shape {cloud.shape}, expected (points, 3)")
    return cloud[np.isfinite(cloud).all(axis=1)]


def read_npy(path):
    return np.load(path, allow_pickle=False)


def header_of(data, last):
    """The lines up to the one that begins with `last`, and where what follows begins."""
    found = re.search(rb"^" + last + rb".*\n", data[:65536], re.MULTILINE)
    if not found:
        raise ValueError(f"has no line {last.decode()} near its beginning")
    return data[:found.end()].decode("ascii").splitlines(), found.end()


def records(data, begin, count, fields, text):
    """`count` records of (name, type) fields: a dictionary of columns."""
    if not 0 <= count <= min(MOST_POINTS, len(data)):
        raise ValueError(f"says that it has {count} points, expected no more than the file can "
                         f"hold, and {MOST_POINTS}")
    names = [name for name, _ in fields]
    if len(set(names)) != len(names) or not {"x", "y", "z"} <= set(names):
        raise ValueError(f"has the fields {', '.join(names)}, expected x, y, z among them")
    if text:
        rows = data[begin:].decode("ascii").split("\n")[:count]
        table = np.array([[float(word) for word in row.split()[:len(names)]] for row in rows])
        if table.shape != (count, len(names)) and count > 0:
            raise ValueError(f"has fewer values than {count} points need")
        return {name: table[:, i] if count else np.zeros(0) for i, name in enumerate(names)}
    table = np.frombuffer(data, np.dtype(fields), count=count, offset=begin) if count else None
    return {name: table[name] if count else np.zeros(0) for name in names}


def xyz(columns):
    return np.stack([columns[axis].astype(float) for axis in "xyz"], axis=1)


def read_ply(path):
    data = path.read_bytes()
    lines, begin = header_of(data, b"end_header")
    if lines[0].strip() != "ply":
        raise ValueError("does not begin with 'ply'")
    form, count, fields, in_vertex = None, None, [], False
    for words in (line.split() for line in lines[1:]):
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            if words[1] == "vertex":
                count, in_vertex = int(words[2]), True
            elif count is None:
                raise ValueError("has other elements before its vertices")
            else:
                in_vertex = False
        elif words[:1] == ["property"] and in_vertex:
            fields.append((words[2], PLY_TYPES[words[1]]))
    if form not in ("ascii", "binary_little_endian") or count is None:
        raise ValueError(f"has the format {form}, expected ascii or binary_little_endian vertices")
    return xyz(records(data, begin, count, fields, form == "ascii"))


def read_pcd(path):
    data = path.read_bytes()
    lines, begin = header_of(data, b"DATA")
    header = {line.split()[0]: line.split()[1:] for line in lines if line and line[0] != "#"}
    form = header["DATA"][0]
    if form not in ("ascii", "binary"):
        raise ValueError(f"has the data {form}, expected ascii or binary")
    fields = []
    counts = header.get("COUNT", ["1"] * len(header["FIELDS"]))
    if sum(int(count) for count in counts) > MOST_FIELDS:
        raise ValueError(f"has more than {MOST_FIELDS} fields")
    for i, name in enumerate(header["FIELDS"]):
        kind = {"F": "<f", "I": "<i", "U": "<u"}[header["TYPE"][i]] + header["SIZE"][i]
        if header["SIZE"][i] not in ("1", "2", "4", "8"):
            raise ValueError(f"has a field of {header['SIZE'][i]} bytes")
        for k in range(int(counts[i])):
            fields.append((name if counts[i] == "1" else f"{name}[{k}]", kind))
    return xyz(records(data, begin, int(header["POINTS"][0]), fields, form == "ascii"))
