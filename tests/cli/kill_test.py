#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Long commands that are killed again and again: kill_test.py PROGRAM MAKE_SMALL_TWIN
MAKE_SMALL_TASK [--all].

Each is killed at random moments (seeded) and gone on with, until a last run comes to its end. What
it wrote is then, byte for byte, what an undisturbed run writes, and nothing else is left. Without
--all there are few kills."""

import pathlib
import random
import subprocess
import sys
import tempfile
import time
import unittest

import disk_cases

PROGRAM, MAKE_SMALL_TWIN, MAKE_SMALL_TASK = sys.argv[1:4]
ALL = '--all' in sys.argv
KILLS_A_ROUND = 5   # then the run may come to its end


class LongCommand:
    """What is killed how often; `share`: of its usual time it lives at most."""

    def __init__(self, kills, few, share, words):
        self.kills = kills if ALL else few
        self.share = share
        self.words = words


def long_commands(inputs):
    cord, task = inputs / 'cord.npz', inputs / 'task'
    train = ['train', cord, '-o', '{out}/cord.twin.npz', '--checkpoint', '0', '--resume']
    return {
        'train': LongCommand(60, 5, 0.8, [*train, '--epochs', '20', '--neighbours', '4,6']),
        'train_two_stage': LongCommand(50, 5, 0.8, [*train, '--method', 'two-stage', '--epochs',
                                                    '200']),
        'diagnose': LongCommand(30, 0, 0.5, ['diagnose', inputs / 'small.twin.npz',
                                             inputs / 'swing.npz', '--heldout',
                                             inputs / 'held.npz', '-o', '{out}/diagnosis',
                                             '--checkpoint', '0', '--resume']),
        'rollout': LongCommand(60, 5, 0.6, ['rollout', task, '--policy', 'random', '--episodes',
                                            '25', '-o', '{out}/sweep']),
    }


class KillTest(unittest.TestCase):
    kills = 0

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix='physpring-kills-')
        cls.root = pathlib.Path(cls.folder.name)
        (cls.root / 'inputs').mkdir()
        cls.inputs = disk_cases.make_inputs(cls.root / 'inputs', PROGRAM, MAKE_SMALL_TWIN,
                                            MAKE_SMALL_TASK)
        cls.out = cls.root / 'out'

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()
        print(f'{cls.kills} kills', file=sys.stderr)

    def run_whole(self, case):
        result = subprocess.run(case.command(PROGRAM, self.out), capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(disk_cases.left_overs(self.out), [])
        return disk_cases.files_in(self.out)

    def kill_once(self, case, seconds, threads):
        """Whether it was killed before it came to its end."""
        command = case.command(PROGRAM, self.out, ['--threads', str(threads)])
        with subprocess.Popen(command, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True) as process:
            time.sleep(seconds)
            process.kill()
            _, errors = process.communicate()
        self.assertIn(process.returncode, (0, -9), errors)
        return process.returncode == -9

    def expect_same(self, whole, found):
        self.assertEqual(sorted(found), sorted(whole))
        for name, content in whole.items():
            self.assertTrue(disk_cases.is_whole(name, found[name], content), name)

    def try_all(self, name):
        command = long_commands(self.inputs)[name]
        if command.kills == 0:
            self.skipTest('only with --all')
        case = disk_cases.Case(name, command.words)
        disk_cases.restore(self.out, {})
        start = time.monotonic()
        whole = self.run_whole(case)
        usual = time.monotonic() - start
        chance = random.Random(name)
        killed = rounds = 0
        while killed < command.kills:
            disk_cases.restore(self.out, {})
            for i in range(KILLS_A_ROUND):
                killed += self.kill_once(case, chance.uniform(0, command.share) * usual, 1 + i % 2)
            self.expect_same(whole, self.run_whole(case))
            rounds += 1
        KillTest.kills += killed
        print(f'{name}: {killed} kills in {rounds} rounds, an undisturbed run takes '
              f'{usual:.1f} s, all {time.monotonic() - start:.0f} s', file=sys.stderr)


def add_tests():
    for name in long_commands(pathlib.Path()):
        def test(self, name=name):
            self.try_all(name)
        setattr(KillTest, f'test_{name}', test)


if __name__ == '__main__':
    add_tests()
    unittest.main(argv=sys.argv[:1])
