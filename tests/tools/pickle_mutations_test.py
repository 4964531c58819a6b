# SPDX-License-Identifier: Apache-2.0
"""Damages pickles and checkpoints at random: they are read, or refused with one line.

    pickle_mutations_test.py                    a few thousand damages, always the same
    pickle_mutations_test.py --runs 1000000 --seed 7 [--keep FOLDER]    many more

The second prints how many were tried and how they ended, keeps what broke the reader in FOLDER, and
ends with status 1 if anything did.
"""

import argparse
import collections
import io
import pathlib
import pickle
import random
import struct
import sys
import tempfile
import time
import unittest
import unittest.mock
import zipfile

import phystwin_test_case  # noqa: F401 - first: it finds the tools, or skips
import hostile_files
import phystwin_case
import phystwin_case_maker as maker
import safe_pickle
from safe_pickle_test import little_memory

SPARE = 64 << 20  # bytes; the files have a few thousand
MOST_SECONDS = 2  # a file takes milliseconds

LENGTHS = [0, 1, 2, 127, 128, 255, 256, 65535, 2 ** 31 - 1, 2 ** 31, 2 ** 32 - 1, 2 ** 62,
           2 ** 63 - 1, 2 ** 64 - 1]
STEPS = [getattr(pickle, name) for name in dir(pickle)
         if isinstance(getattr(pickle, name), bytes) and len(getattr(pickle, name)) == 1]


def seeds(folder):
    """[(file name, bytes)] of files that PhysTwin could have written, and of hostile ones."""
    data = maker.final_data(frames=2, points=5, surface=2, interior=1, controllers=1)
    maker.torch_save(maker.checkpoint([3e4, 2e4, 1e4], 2), folder / "best_0.pth")
    found = 10 * [("best_0.pth", (folder / "best_0.pth").read_bytes())]
    for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
        found += [("final_data.pkl", pickle.dumps(data, protocol)),
                  ("optimal_params.pkl", pickle.dumps(maker.PARAMETERS, protocol)),
                  ("gt_track_3d.pkl", pickle.dumps(data["object_points"][:, :2], protocol))]
    found += [("final_data.pkl", hostile) for hostile in hostile_files.pickles().values()
              if 0 < len(hostile) < 3000]
    return found


def damage(data, others, source):
    """The bytes with one part changed, taken out, put in or doubled."""
    data, kind = bytearray(data), source.randrange(8)
    at = source.randrange(len(data) + 1)
    end = min(len(data), at + source.choice((1, 1, 2, 4, 8, 40, 400)))
    if kind == 0:
        data[at:at + 1] = bytes([source.randrange(256)])
    elif kind == 1:
        if at < len(data):
            data[at] ^= 1 << source.randrange(8)
    elif kind == 2:
        del data[at:end]
    elif kind == 3:
        data[at:at] = data[at:end] * source.choice((1, 2, 50))
    elif kind == 4:
        data[at:at] = source.choice(STEPS)
    elif kind == 5:
        code = source.choice(("<B", "<I", "<Q"))
        value = source.choice(LENGTHS) % (1 << 8 * struct.calcsize(code))
        data[at:at + struct.calcsize(code)] = struct.pack(code, value)
    elif kind == 6:
        other = source.choice(others)[1]
        begin = source.randrange(len(other))
        data[at:end] = other[begin:begin + source.choice((4, 40, 400))]
    else:
        data[at:] = b""
    return bytes(data)


def damage_inside(data, others, source):
    """A checkpoint whose pickle is damaged, its table of contents whole."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as old, zipfile.ZipFile(buffer, "w") as new:
        for name in old.namelist():
            member = old.read(name)
            if name.endswith("data.pkl"):
                member = damage(member, others, source)
            new.writestr(name, member)
    return buffer.getvalue()


def read(path, folder):
    """Reads a file as the converter does, and what is in it."""
    if path.name == "best_0.pth":
        phystwin_case.read_checkpoint(path)
    elif path.name == "optimal_params.pkl":
        phystwin_case.read_parameters(path)
    elif path.name == "gt_track_3d.pkl":
        phystwin_case.read_track(path, 2, True)
    else:
        phystwin_case.read_case(folder)


def outcome(path, folder):
    """(how reading ended, whether that is wrong)"""
    begin = time.process_time()
    try:
        read(path, folder)
        ended, wrong = "read", False
    except safe_pickle.Error as error:
        line = str(error)
        wrong = not line.startswith(str(path)) or "more memory" in line or not line.isprintable()
        ended = f"refused: {ascii(line[-80:])}" if wrong else "refused"
    except Exception as error:  # what must not be
        ended, wrong = f"{type(error).__name__}: {str(error)[:80]}", True
    if time.process_time() - begin > MOST_SECONDS:
        ended, wrong = f"took more than {MOST_SECONDS} s", True
    return ended, wrong


def damaged(corpus, source):
    """(file name, bytes) of one of the corpus, damaged."""
    name, data = source.choice(corpus)
    if name == "best_0.pth" and source.random() < 0.8:
        return name, damage_inside(data, corpus, source)
    for _ in range(source.choice((1, 1, 1, 2, 5))):
        data = damage(data, corpus, source) if data else data
    return name, data


def try_damages(runs, seed, keep=None):
    """(how often each outcome came, the outcomes that are wrong)"""
    source, counts, wrong_ones = random.Random(seed), collections.Counter(), []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        corpus = seeds(folder)
        with little_memory(SPARE):
            for run in range(runs):
                name, data = damaged(corpus, source)
                (folder / name).write_bytes(data)
                ended, wrong = outcome(folder / name, folder)
                counts[f"{name} {ended}"] += 1
                (folder / "gt_track_3d.pkl").unlink(missing_ok=True)
                if not wrong:
                    continue
                wrong_ones.append(f"run {run} of seed {seed}, {name}: {ended}")
                if keep is not None:
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{seed}_{run}_{name}").write_bytes(data)
    return counts, wrong_ones


class PickleMutationsTest(unittest.TestCase):
    def test_damaged_files_are_read_or_refused(self):
        counts, wrong = try_damages(4000, seed=1)
        self.assertEqual(wrong, [])
        for name in ("final_data.pkl", "optimal_params.pkl", "best_0.pth", "gt_track_3d.pkl"):
            self.assertGreater(counts[name + " refused"], 100)  # it does damage
            self.assertGreater(counts[name + " read"], 10)  # and comes as far as the numbers

    def test_what_breaks_the_reader_is_found(self):
        with unittest.mock.patch.object(phystwin_case, "require_places", lambda *_: 1 / 0):
            self.assertIn("ZeroDivisionError", "".join(try_damages(200, seed=1)[1]))


def main(argv):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("--runs", type=int, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=pathlib.Path, metavar="FOLDER")
    args = parser.parse_args(argv)
    begin = time.monotonic()
    counts, wrong = try_damages(args.runs, args.seed, args.keep)
    for ended, count in counts.most_common():
        print(f"{count:9} {ended}")
    print(f"{args.runs} files in {time.monotonic() - begin:.0f} s, {len(wrong)} wrong")
    print("\n".join(wrong[:20]))
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) > 1:
        sys.exit(main(sys.argv[1:]))
    unittest.main()
