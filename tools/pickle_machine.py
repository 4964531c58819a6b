# SPDX-License-Identifier: Apache-2.0
"""Runs a pickle, which is a program, with the few steps that build plain values.

It knows the steps of protocols 0 to 5 for None, numbers, texts, bytes, tuples, lists and
dictionaries, and calls only what the caller names. No step takes more memory than its own bytes in
the file, times a constant: lengths are compared with what is left, the memo is a dictionary, and
the number of steps is limited. No step takes long: keys of dictionaries are short and plain, since
hashing a tuple that shares its parts can take for ever.
"""

import collections
import pickle
import struct

MOST_STEPS = 1_000_000  # PhysTwin's files take hundreds
MOST_DIGITS = 1000  # of a number, and bytes of a long one
MOST_KEY = 1000  # characters of a dictionary's key
MOST_KEYS = 10_000  # which may all have the same hash
MOST_ARGUMENTS = 16
MOST_PROTOCOL = 5


class Error(Exception):
    """Bad input, in one line."""


def shown(value):
    """The value for a message: short, in ASCII and on one line, whatever it is."""
    if isinstance(value, str):
        return ascii(value[:60])
    if isinstance(value, int) and abs(value) < 1 << 70:
        return str(value)
    if isinstance(value, tuple) and len(value) <= 8 and all(isinstance(n, int) for n in value):
        return "(" + ", ".join(map(shown, value)) + ")"
    return type(value).__name__


def _text(encoding, errors="strict"):
    return lambda data: str(data, encoding, errors)


def _line_int(data):
    if data in (b"00", b"01"):  # how protocol 0 writes False and True
        return data == b"01"
    return int(data.rstrip(b"L"))


def _line_string(data):
    if len(data) < 2 or data[:1] != data[-1:] or data[:1] not in (b"'", b'"'):
        raise ValueError("a string without quotes")
    return str(data[1:-1], "unicode-escape")


def _long(data):
    if len(data) > MOST_DIGITS:
        raise ValueError("a number that is too long")
    return int.from_bytes(data, "little", signed=True)


def _number(code):
    return lambda data: struct.unpack(code, data)[0]


# step: (bytes of the value, or a struct code of its length, or "line"; the value from its bytes)
_VALUES = {
    pickle.NONE: (0, lambda data: None),
    pickle.NEWTRUE: (0, lambda data: True),
    pickle.NEWFALSE: (0, lambda data: False),
    pickle.EMPTY_TUPLE: (0, lambda data: ()),
    pickle.EMPTY_LIST: (0, lambda data: []),
    pickle.EMPTY_DICT: (0, lambda data: {}),
    pickle.INT: ("line", _line_int),
    pickle.LONG: ("line", _line_int),
    pickle.FLOAT: ("line", float),
    pickle.STRING: ("line", _line_string),
    pickle.UNICODE: ("line", _text("raw-unicode-escape")),
    pickle.BININT: (4, _number("<i")),
    pickle.BININT1: (1, _number("<B")),
    pickle.BININT2: (2, _number("<H")),
    pickle.BINFLOAT: (8, _number(">d")),
    pickle.LONG1: ("<B", _long),
    pickle.LONG4: ("<i", _long),
    pickle.BINSTRING: ("<i", _text("ascii")),
    pickle.SHORT_BINSTRING: ("<B", _text("ascii")),
    pickle.BINUNICODE: ("<I", _text("utf-8", "surrogatepass")),
    pickle.SHORT_BINUNICODE: ("<B", _text("utf-8", "surrogatepass")),
    pickle.BINUNICODE8: ("<Q", _text("utf-8", "surrogatepass")),
    pickle.BINBYTES: ("<I", lambda data: data),
    pickle.SHORT_BINBYTES: ("<B", lambda data: data),
    pickle.BINBYTES8: ("<Q", lambda data: data),
    pickle.BYTEARRAY8: ("<Q", lambda data: data),
}
_TUPLES = {pickle.TUPLE1: 1, pickle.TUPLE2: 2, pickle.TUPLE3: 3}
_PUTS = {pickle.BINPUT: "<B", pickle.LONG_BINPUT: "<I"}
_GETS = {pickle.BINGET: "<B", pickle.LONG_BINGET: "<I"}


def _are_arguments(value):
    return isinstance(value, tuple) and len(value) <= MOST_ARGUMENTS


class Machine:
    """Builds the value of a pickle. `names`: what (module, name) stands for; `persistent`: called
    with an id of data outside. Bytes come as memoryviews of `data`."""

    def __init__(self, data, names, persistent=None):
        self._bytes, self._data, self._at = data, memoryview(data), 0
        self._names, self._persistent = names, persistent
        self._stack, self._outer, self._memo = [], [], {}
        self._made = 0  # bytes made by calls
        self._keys = 0  # of all dictionaries

    def load(self):
        for _ in range(MOST_STEPS):
            step = bytes(self._take(1))
            if step == pickle.STOP:
                return self._stack.pop()
            self._run(step)
        raise Error(f"takes more than {MOST_STEPS} steps")

    def _take(self, count):
        if not 0 <= count <= len(self._data) - self._at:
            raise ValueError(f"{count} bytes are asked for, {len(self._data) - self._at} are left")
        self._at += count
        return self._data[self._at - count:self._at]

    def _int(self, code):
        return struct.unpack(code, self._take(struct.calcsize(code)))[0]

    def _line(self, most):
        """The bytes up to the next end of line, at most so many."""
        found = self._bytes.find(b"\n", self._at, self._at + most + 1)
        if found < 0:
            raise ValueError("a line without end, or too long")
        return bytes(self._take(found + 1 - self._at))[:-1]

    def _items(self):
        """What was put on the stack since the last mark."""
        items, self._stack = self._stack, self._outer.pop()
        return items

    def _run(self, step):
        if step in _VALUES:
            length, value_of = _VALUES[step]
            if length == "line":
                number = step in (pickle.INT, pickle.LONG, pickle.FLOAT)
                data = self._line(MOST_DIGITS if number else len(self._data) - self._at)
            else:
                data = self._take(length if isinstance(length, int) else self._int(length))
            self._stack.append(value_of(data))
        elif step in _TUPLES:
            count = _TUPLES[step]
            if len(self._stack) < count:
                raise IndexError("too few values")
            self._stack[-count:] = [tuple(self._stack[-count:])]
        elif step in _PUTS:
            self._memoize(self._int(_PUTS[step]))
        elif step in _GETS:
            self._stack.append(self._memo[self._int(_GETS[step])])
        elif step in _STEPS:
            _STEPS[step](self)
        else:
            raise Error(f"has the step {ascii(step)}, which does not build data: refused")

    def _protocol(self):
        protocol = self._int("<B")
        if protocol > MOST_PROTOCOL:
            raise ValueError(f"protocol {protocol}")

    def _mark(self):
        self._outer.append(self._stack)
        self._stack = []

    def _collect(self, kind):
        items = self._items()
        self._stack.append(kind(items))

    def _append(self, items):
        if type(self._stack[-1]) is not list:
            raise TypeError("appends to what is no list")
        self._stack[-1].extend(items)

    def _set(self, items):
        target = self._stack[-1]
        if not isinstance(target, dict):
            raise TypeError("sets items of what is no dictionary")
        if len(items) % 2:
            raise ValueError("a key without value")
        self._keys += len(items) // 2
        if self._keys > MOST_KEYS:
            raise Error(f"has more than {MOST_KEYS} keys of dictionaries")
        for key, value in zip(items[::2], items[1::2]):
            if not isinstance(key, (str, int, float, type(None))) or (
                    isinstance(key, str) and len(key) > MOST_KEY):
                raise Error(f"has a key of a dictionary that is not short and plain: {shown(key)}")
            target[key] = value

    def _dict(self):
        items = self._items()
        self._stack.append({})
        self._set(items)

    def _setitem(self):
        value, key = self._stack.pop(), self._stack.pop()
        self._set([key, value])

    def _find(self, module, name):
        if not isinstance(module, str) or not isinstance(name, str):
            raise TypeError("a name that is no text")
        if len(module) + len(name) > MOST_KEY or (module, name) not in self._names:
            full = ascii(f"{module[:60]}.{name[:60]}")[1:-1]
            raise Error(f"names {full}, which is not data: refused")
        self._stack.append(self._names[module, name])

    def _stack_global(self):
        name, module = self._stack.pop(), self._stack.pop()
        self._find(module, name)

    def _reduce(self):
        arguments, function = self._stack.pop(), self._stack.pop()
        if not callable(function) or not _are_arguments(arguments):
            raise TypeError("calls what is no function")
        value = function(*arguments)
        if isinstance(value, bytes):
            self._made += len(value)
            if self._made > len(self._data):  # each byte of a file is encoded once
                raise Error("makes more bytes than it has")
        self._stack.append(value)

    def _build(self):
        state, target = self._stack.pop(), self._stack[-1]
        if isinstance(target, collections.OrderedDict):
            return  # torch keeps attributes beside the items; none is needed
        if not hasattr(target, "__setstate__"):
            raise TypeError(f"gives a state to a {type(target).__name__}")
        target.__setstate__(state)

    def _persist(self, identity):
        if self._persistent is None:
            raise Error("refers to data outside the file")
        if not _are_arguments(identity):
            raise TypeError("data outside the file without a description")
        self._stack.append(self._persistent(*identity))

    def _memoize(self, index):
        if not 0 <= index < 1 << 32:
            raise ValueError(f"memo {shown(index)}")
        self._memo[index] = self._stack[-1]


_STEPS = {
    pickle.PROTO: Machine._protocol,
    pickle.FRAME: lambda self: self._take(8),
    pickle.POP: lambda self: self._stack.pop() if self._stack else self._items(),
    pickle.POP_MARK: Machine._items,
    pickle.DUP: lambda self: self._stack.append(self._stack[-1]),
    pickle.MARK: Machine._mark,
    pickle.TUPLE: lambda self: self._collect(tuple),
    pickle.LIST: lambda self: self._collect(list),
    pickle.DICT: Machine._dict,
    pickle.APPEND: lambda self: self._append([self._stack.pop()]),
    pickle.APPENDS: lambda self: self._append(self._items()),
    pickle.SETITEM: Machine._setitem,
    pickle.SETITEMS: lambda self: self._set(self._items()),
    pickle.PUT: lambda self: self._memoize(int(self._line(MOST_DIGITS))),
    pickle.GET: lambda self: self._stack.append(self._memo[int(self._line(MOST_DIGITS))]),
    pickle.MEMOIZE: lambda self: self._memoize(len(self._memo)),
    pickle.GLOBAL: lambda self: self._find(*(str(self._line(MOST_KEY), "utf-8") for _ in "mn")),
    pickle.STACK_GLOBAL: Machine._stack_global,
    pickle.REDUCE: Machine._reduce,
    pickle.BUILD: Machine._build,
    pickle.PERSID: lambda self: self._persist(str(self._line(MOST_KEY), "ascii")),
    pickle.BINPERSID: lambda self: self._persist(self._stack.pop()),
}
