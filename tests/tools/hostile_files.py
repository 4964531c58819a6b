# SPDX-License-Identifier: Apache-2.0
"""Files that are made to harm who reads them: pickles and torch checkpoints of a few kilobytes."""

import io
import pickle
import struct
import zipfile

ZEROS = 400 << 20  # bytes of a member that is packed to a thousandth


def text(value):
    return pickle.SHORT_BINUNICODE + bytes([len(value)]) + value.encode()


def call(name, arguments):
    return b"c" + name.encode() + b"\n" + arguments + pickle.REDUCE


def entry(key, value):
    """A pickle of {key: value}, where the value is given by its steps."""
    return pickle.EMPTY_DICT + text(key) + value + pickle.SETITEM + pickle.STOP


def laughs(levels=200):
    """A tuple of two tuples of two ... that are one: its parts are 2^levels."""
    return b")" + levels * (pickle.DUP + pickle.TUPLE2)


def array(shape=b"K\x06K\x28K\x03\x87", dtype=b"X\x02\0\0\0f4", order=b"X\x01\0\0\0C", data=b"C\0"):
    """Steps of an array as numpy's protocol 5 has it."""
    kind = call("numpy\ndtype", dtype + b"\x89\x88\x87")
    return call("numpy.core.numeric\n_frombuffer", b"(" + data + kind + shape + order + b"t")


def long(count):
    """Steps of an integer of so many bytes."""
    return pickle.LONG4 + struct.pack("<i", count) + (count - 1) * b"\x01" + b"\x01"


def pickles():
    """{what it does: bytes}"""
    hashes_alike = b"".join(
        long(12)[:5] + (n * (2 ** 61 - 1)).to_bytes(12, "little") + b"N" for n in range(200_000))
    latin = b"X" + struct.pack("<I", 1 << 20) + (1 << 20) * b"x" + b"q\0"
    encode = call("_codecs\nencode", b"h\0" + text("latin1") + b"\x86")
    return {
        "nothing": b"",
        "no value": b".",
        "no dictionary": b"K\x01.",
        "memo bomb": b"N" + pickle.LONG_BINPUT + b"\xff\xff\xff\x7f" + b".",
        "memo bomb, text": b"Np4294967295\n.",
        "memo of many digits": b"Np" + 5000 * b"9" + b"\n.",
        "negative memo": b"Np-1\n.",
        "memo that is not there": b"h\x07.",
        "8 exabytes": pickle.BINBYTES8 + struct.pack("<Q", 1 << 62) + b".",
        "8 exabytes, mutable": pickle.BYTEARRAY8 + struct.pack("<Q", 1 << 40) + b".",
        "8 exabytes of text": pickle.BINUNICODE8 + struct.pack("<Q", 1 << 63) + b".",
        "4 gigabytes": pickle.BINBYTES + b"\xff\xff\xff\xff.",
        "negative length": pickle.LONG4 + b"\xff\xff\xff\xff.",
        "long frame": b"\x80\x04\x95" + 8 * b"\xff" + b".",
        "digits": b"I" + 100_000 * b"9" + b"\n.",
        "digits of a long": b"L" + 100_000 * b"9" + b"L\n.",
        "shape of many digits": entry("object_points", array(shape=long(5000) + b"\x85")),
        "shape as large as can be": entry("object_points", array(shape=long(8) + b"\x85")),
        "shape that overflows": entry("object_points", array(shape=long(7) + b"K\0\x86")),
        "shape of two to the 200 parts": entry("object_points", array(shape=laughs())),
        "type of two to the 200 parts": entry("object_points", array(dtype=laughs())),
        "order of two to the 200 parts": entry("object_points", array(order=laughs())),
        "bytes of two to the 200 parts": entry("object_points", array(data=laughs())),
        "key of two to the 200 parts": b"}" + laughs() + b"Ns.",
        "keys of one hash": b"}(" + hashes_alike + b"u.",
        "long key": b"}X" + struct.pack("<I", 5000) + 5000 * b"k" + b"Ns.",
        "state of two to the 200 parts":
            b"cnumpy.core.multiarray\n_reconstruct\n)R" + laughs() + b"b.",
        "20 million dictionaries": 20_000_000 * b"}" + b".",
        "20 million marks": 20_000_000 * b"(" + b".",
        "deep": 900_000 * b"(" + 99_000 * b"t" + b".",
        "a list in itself": b"]q\0h\0a.",
        "a thousand copies": latin + b"(" + 1000 * encode + b"l.",
        "out-of-band data": b"\x80\x05\x97.",
        "a number of the registry": b"\x82\x01.",
        "an id": b"Pdata\n.",
        "a class": b"c__main__\nCase\n)\x81.",
        "a long name": b"c" + 900 * b"m" + b"\n" + 900 * b"n" + b"\n.",
        "a name with escapes": b"c\x1b[2J\n\x1b]0;x\x07\n.",
        "a name of surrogates": b"\x8c\x03\xed\xa0\x80\x8c\x03\xed\xa0\x80\x93.",
        "protocol 9": b"\x80\x09N.",
        "call of data": b"}K\x01\x85R.",
        "call with a list": b"c_codecs\nencode\n]R.",
        "state of a number": b"K\x01}b.",
    }


def archive(members, change=None, compression=zipfile.ZIP_STORED):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", compression) as file:
        for name, data in members:
            file.writestr("best/" + name, data)
    data = bytearray(buffer.getvalue())
    if change:
        change(data)
    return bytes(data)


def _in_directory(offset, value):
    """Changes a field of each entry in the table of contents."""
    def change(data):
        at = data.find(b"PK\1\2")
        while at >= 0:
            data[at + offset:at + offset + len(value)] = value
            at = data.find(b"PK\1\2", at + 4)
    return change


def _directory_size(data):
    at = data.rfind(b"PK\5\6")
    data[at + 12:at + 16] = b"\xf0\xff\xff\xff"


def storage(key=b"X\x01\0\0\x000", kind=b"ctorch\nFloatStorage\n", count=b"K\x01"):
    """A pickle that refers to a storage."""
    return b"(" + text("storage") + kind + key + text("cpu") + count + b"tQ."


def checkpoints():
    """{what it does: bytes}"""
    good = [("data.pkl", storage()), ("byteorder", b"little"), ("data/0", b"\0\0\0\0")]
    packed = [good[0], ("byteorder", bytes(ZEROS)), good[2]]
    tensor = b"ctorch._utils\n_rebuild_tensor_v2\n(" + storage()[:-1]
    return {
        "nothing": b"",
        "no zip": b"PK\3\4",
        "encrypted": archive(good, _in_directory(8, b"\1\0")),
        "unknown packing": archive(good, _in_directory(10, b"\x63\0")),
        "version 25.5": archive(good, _in_directory(6, b"\xff\0")),
        "members elsewhere": archive(good, _in_directory(42, b"\xff\xff\xff\x7f")),
        "size of 4 GB": archive(good, _in_directory(24, b"\xfe\xff\xff\xff")),
        "wrong sum": archive(good, _in_directory(16, b"abcd")),
        "table of 4 GB": archive(good, _directory_size),
        "packed byteorder": archive(packed, compression=zipfile.ZIP_DEFLATED),
        "other byteorder": archive([good[0], ("byteorder", b"big"), good[2]]),
        "no pickle": archive(good[1:]),
        "two pickles": archive([*good, ("inner/data.pkl", b"N.")]),
        "30,000 members": archive([(f"data/{n}", b"") for n in range(1, 30_000)] + good),
        "no storage": archive([("data.pkl", storage(key=text("7")))]),
        "key of many parts": archive([("data.pkl", storage(key=laughs())), *good[1:]]),
        "kind of many parts": archive([("data.pkl", storage(kind=laughs())), *good[1:]]),
        "count of many digits": archive([("data.pkl", storage(count=long(900))), *good[1:]]),
        "negative count": archive([("data.pkl", storage(count=b"J\xff\xff\xff\xff")), *good[1:]]),
        "size of many digits": archive([
            ("data.pkl", b"}" + text("spring_Y") + tensor + b"K\0(" + 90 * long(900) + b"t(" +
             90 * b"K\1" + b"t\x89Nt" + b"Rs."), *good[1:]]),
        **{f"pickle: {name}": archive([("data.pkl", data), *good[1:]])
           for name, data in pickles().items() if len(data) < 100_000},
    }
