#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every command that writes, on a disk that fails: fault_test.py PROGRAM MAKE_SMALL_TWIN
MAKE_SMALL_TASK FAULTY_FILES [--all].

A library lets one call on files below the output folder fail, each in turn. Then either the run
succeeds and its results are whole, or it ends with status 1 and one line that names a file, and what
was there before is as it was, or new and whole. Nothing temporary is left, unless removing was what
failed; the next run then removes it. Without --all only some of the faults are tried."""

import errno
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

import disk_cases

PROGRAM, MAKE_SMALL_TWIN, MAKE_SMALL_TASK, FAULTY_FILES = sys.argv[1:5]
ALL = '--all' in sys.argv
SOME = 9            # of so many faults one is tried without --all
MOST = 40           # of the calls of one kind in one run, spread evenly
ERRORS = {'open': (errno.EACCES, errno.ENOSPC), 'write': (errno.EIO, errno.ENOSPC, 0),
          'fsync': (errno.EIO,), 'close': (errno.EIO,), 'rename': (errno.EIO,),
          'mkdir': (errno.ENOSPC,), 'unlink': (errno.EIO,), 'link': (errno.EPERM,),
          'flock': (errno.ENOLCK,)}
FOREVER = 10 ** 9


class FaultTest(unittest.TestCase):
    faults = 0

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix='physpring-faults-')
        cls.root = pathlib.Path(cls.folder.name)
        (cls.root / 'inputs').mkdir()
        cls.inputs = disk_cases.make_inputs(cls.root / 'inputs', PROGRAM, MAKE_SMALL_TWIN,
                                            MAKE_SMALL_TASK)
        cls.out = cls.root / 'out'

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()
        print(f'{cls.faults} faults', file=sys.stderr)

    def run_case(self, case, again, call='', first=0, last=0, error=0):
        environment = dict(os.environ, LD_PRELOAD=FAULTY_FILES, FAULT_FOLDER=f'{self.out}/',
                           FAULT_CALL=call, FAULT_AT=str(first), FAULT_LAST=str(last),
                           FAULT_ERROR=str(error), FAULT_COUNTS=str(self.root / 'counts'),
                           ASAN_OPTIONS='verify_asan_link_order=0:detect_leaks=0')
        command = case.command(PROGRAM, self.out, case.again if again else ())
        return subprocess.run(command, env=environment, capture_output=True, text=True, timeout=300)

    def counts(self):
        lines = (self.root / 'counts').read_text().splitlines()
        return {call: int(count) for call, count in map(str.split, lines)}

    def expect_whole(self, names, whole, found):
        for name in names:
            self.assertIn(name, found)
            self.assertTrue(disk_cases.is_whole(name, found[name], whole[name]), name)

    def expect_old_or_whole(self, old, whole, found):
        for name, content in found.items():
            if content == old.get(name) or disk_cases.is_left_over(name):
                continue
            self.assertIn(name, whole)
            if not disk_cases.is_whole(name, content, whole[name]):
                self.expect_checkpoint(self.out / name)
        self.assertEqual([name for name in old if name not in found], [])

    def expect_checkpoint(self, path):
        """Something else that is whole: an unfinished twin, or what a diagnosis goes on from."""
        if path.name == 'checkpoint.npz':
            return   # the next run, with --resume, shows whether it is sound
        self.assertTrue(path.name.endswith('.twin.npz'), path.name)
        result = subprocess.run([PROGRAM, 'info', path], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn('is not finished', result.stderr)

    def expect_one_line(self, result):
        lines = [line for line in result.stderr.splitlines() if line.startswith('physpring: ')]
        self.assertEqual(len(lines), 1, result.stderr)
        self.assertIn(str(self.out), lines[0])

    def check(self, case, old, whole, call, first, last, error):
        disk_cases.restore(self.out, old)
        result = self.run_case(case, bool(old), call, first, last, error)
        found = disk_cases.files_in(self.out)
        left = disk_cases.left_overs(self.out)
        if result.returncode == 0:
            self.expect_whole(whole, whole, found)
        else:
            self.assertEqual(result.returncode, 1, result.stderr)
            self.expect_one_line(result)
            self.expect_old_or_whole(old, whole, found)
        if call != 'unlink':
            self.assertEqual(left, [])
        if result.returncode != 0 or left:
            more = case.again if found else ()
            if case.name == 'train' and not old:
                more = ['--resume']  # from a checkpoint, if there is one
            again = subprocess.run(case.command(PROGRAM, self.out, more), capture_output=True,
                                   text=True)
            self.assertEqual(again.returncode, 0, again.stderr)
            self.expect_whole(whole, whole, disk_cases.files_in(self.out))
            self.assertEqual(disk_cases.left_overs(self.out), [])

    def faults_of(self, counts):
        for call, errors in ERRORS.items():
            count = counts[call]
            places = range(1, count + 1)
            if count > MOST:
                places = sorted({1 + i * (count - 1) // (MOST - 1) for i in range(MOST)})
            for place in places:
                for error in errors:
                    yield call, place, place, error
            if count > 0 and call in ('write', 'fsync'):
                yield call, 1 + count // 2, FOREVER, errno.ENOSPC

    def try_all(self, case):
        if case.name == 'diagnose' and not ALL:
            self.skipTest('takes a while; only with --all')
        disk_cases.restore(self.out, {})
        result = self.run_case(case, False)
        self.assertEqual(result.returncode, 0, result.stderr)
        whole = disk_cases.files_in(self.out)
        self.assertEqual(disk_cases.left_overs(self.out), [])
        start, before = time.monotonic(), FaultTest.faults
        # where nothing was, and where something was; a diagnosis that is done writes at once
        for old in ([whole] if case.name == 'diagnose' else [{}, whole]):
            disk_cases.restore(self.out, old)
            self.run_case(case, bool(old))
            for i, fault in enumerate(self.faults_of(self.counts())):
                if not ALL and i % SOME != 0:
                    continue
                FaultTest.faults += 1
                with self.subTest(case=case.name, old=bool(old), fault=fault):
                    self.check(case, old, whole, *fault)
        print(f'{case.name}: {FaultTest.faults - before} faults, '
              f'{time.monotonic() - start:.0f} s', file=sys.stderr)


def add_tests():
    for case in disk_cases.cases(pathlib.Path('{inputs}')):
        def test(self, name=case.name):
            self.try_all(next(c for c in disk_cases.cases(self.inputs) if c.name == name))
        setattr(FaultTest, f'test_{case.name}', test)


if __name__ == '__main__':
    add_tests()
    unittest.main(argv=sys.argv[:1])
