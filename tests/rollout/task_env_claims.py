# SPDX-License-Identifier: Apache-2.0
"""What the Python example's resets and steps promise; run by task_env_test.py with MuJoCo.

task_env_claims.py EXAMPLE TASK, with the plugin's path in PHYSPRING_PLUGIN
"""
import os
import pathlib
import sys
import tempfile
import unittest

import mujoco
import numpy as np

EXAMPLE, TASK = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
sys.path.insert(0, str(EXAMPLE.resolve().parent))
from task_env import TaskEnv  # noqa: E402

GOOD = np.array([0.04, -0.05, 0.03, 1, 0, 0, 0, 0])


class TaskEnvClaims(unittest.TestCase):
    def setUp(self):
        self.env = TaskEnv(TASK)

    def starts(self, env, seeds):
        return [env.reset(seed=seed)[0]['nodes'] for seed in seeds]

    def test_same_seed_gives_the_same_start(self):
        first, other, again = self.starts(self.env, [3, 4, 3])
        np.testing.assert_array_equal(first, again)
        self.assertGreater(np.abs(first - other).max(), 1e-5)  # noise of the starts: 2 mm

    def test_resets_after_the_same_seed_start_at_the_same_places(self):
        seeds = [3, None, None]
        starts = self.starts(self.env, seeds)
        np.testing.assert_array_equal(starts, self.starts(TaskEnv(TASK), seeds))
        np.testing.assert_array_equal(starts, self.starts(self.env, seeds))
        self.assertGreater(np.abs(starts[0] - starts[1]).max(), 1e-5)

    def test_declared_start_draws_nothing(self):
        start = {'position': [0, 0, 0.006], 'quaternion': [1, 0, 0, 0]}
        self.env.reset(seed=3, options={'start': start})
        np.testing.assert_array_equal(self.starts(self.env, [None]), self.starts(self.env, [3]))

    def test_steps_after_a_reset_are_those_of_a_new_environment(self):
        def nodes(env):
            env.reset(seed=3)
            return [env.step(GOOD)[0]['nodes'] for _ in range(5)]
        first = nodes(self.env)
        np.testing.assert_array_equal(nodes(self.env), first)
        np.testing.assert_array_equal(nodes(TaskEnv(TASK)), first)

    def test_action_that_cannot_be_followed_is_refused_and_changes_nothing(self):
        self.env.reset(seed=3)
        expected = self.env.step(GOOD)[0]
        for place in range(8):
            for value in (np.nan, np.inf):
                action = GOOD.copy()
                action[place] = value
                self.check_refused(action, expected)
        for action in (np.zeros(8), np.zeros(7), GOOD[:7], [GOOD], 0, [],
                       np.where(np.arange(8) == 3, 1e-4, GOOD)):
            self.check_refused(action, expected)

    def check_refused(self, action, expected):
        self.env.reset(seed=3)
        with self.assertRaisesRegex(ValueError, 'quaternion|8 finite numbers'):
            self.env.step(action)
        for key, value in self.env.step(GOOD)[0].items():
            np.testing.assert_array_equal(value, expected[key])

    def test_instability_is_no_silent_reset(self):
        for values in (self.env.data.qpos, self.env.data.qvel):
            for value in (np.nan, 1e12):
                self.env.reset(seed=3)
                values[-1] = value
                with self.assertRaisesRegex(RuntimeError, 'MuJoCo warns'):
                    self.env.step(GOOD)
                with self.assertRaisesRegex(RuntimeError, 'reset'):
                    self.env.step(GOOD)
                np.testing.assert_array_equal(self.starts(self.env, [3]),
                                              self.starts(TaskEnv(TASK), [3]))

    def test_reset_comes_first(self):
        with self.assertRaisesRegex(RuntimeError, 'reset'):
            self.env.step(GOOD)

    def test_start_without_direction_is_refused(self):
        with self.assertRaisesRegex(ValueError, 'quaternion'):
            self.env.reset(options={'start': {'position': [0, 0, 0], 'quaternion': [0, 0, 0, 0]}})


if __name__ == '__main__':
    mujoco.mj_loadPluginLibrary(os.environ['PHYSPRING_PLUGIN'])
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # where MuJoCo writes its log
        unittest.main(argv=sys.argv[:1])
