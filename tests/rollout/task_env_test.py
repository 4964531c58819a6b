# SPDX-License-Identifier: Apache-2.0
"""The Python example gives the states of `physpring rollout`, in stock MuJoCo, and keeps what it
promises of resets and steps (task_env_claims.py).

task_env_test.py PHYSPRING MAKE_SMALL_TASK PLUGIN EXAMPLE ENVIRONMENT
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from python_environment import python_with

PHYSPRING, MAKE_TASK, PLUGIN, EXAMPLE, ENVIRONMENT = sys.argv[1:]


class TaskEnvTest(unittest.TestCase):
    def test_states_are_those_of_the_runner(self):
        with tempfile.TemporaryDirectory() as folder:
            task, out = pathlib.Path(folder) / 'task', pathlib.Path(folder) / 'out'
            subprocess.run([MAKE_TASK, task], check=True)
            subprocess.run([PHYSPRING, 'rollout', task, '--policy', f'replay:{task}/push.npz',
                            '--level', '0,2', '--seed', '3', '-o', out],
                           check=True, stdout=subprocess.DEVNULL)
            for level in (0, 2):
                done = subprocess.run(
                    [PYTHON, EXAMPLE, task, '--level', str(level), '--episode',
                     out / f'level{level}' / 'episode_00000'],
                    env={**os.environ, 'PHYSPRING_PLUGIN': PLUGIN}, capture_output=True, text=True)
                print(done.stdout.strip())
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertNotIn('moved by up to 0 m', done.stdout)

    def test_resets_and_steps_are_as_promised(self):
        with tempfile.TemporaryDirectory() as folder:
            task = pathlib.Path(folder) / 'task'
            subprocess.run([MAKE_TASK, task], check=True)
            done = subprocess.run(
                [PYTHON, '-W', 'error', pathlib.Path(__file__).with_name('task_env_claims.py'),
                 EXAMPLE, task],
                env={**os.environ, 'PHYSPRING_PLUGIN': PLUGIN}, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


PYTHON = python_with(ENVIRONMENT, ['mujoco-core==4.0.0'])
if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
