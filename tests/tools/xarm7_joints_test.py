#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tasks in which servos in its joints move the xArm7: the servos follow without ringing, what the
weld's hand did succeeds as joint angles too, and a policy of openpi's for DROID drives the arm.

xarm7_joints_test.py PHYSPRING PROJECT ENVIRONMENT [EPISODES]

Prints the figures that it judges. Skipped (77) where the robot or packages cannot be downloaded.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PHYSPRING, PROJECT, ENVIRONMENT = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
EPISODES = int(sys.argv[4]) if len(sys.argv) > 4 else 2
PACKAGES = ['mujoco-core==4.0.0', 'numpy<2', 'openpi-client==0.1.2', 'websockets>=14', 'einops']
TASKS = ('rope_routing', 'toy_packing', 't_push', 'cloth_folding')
ROPE = PROJECT / '.deps/xarm7_joints/rope_routing'

sys.path[:0] = [str(PROJECT / 'tests/rollout'), str(PROJECT / 'tools')]
from python_environment import python_with  # noqa: E402
from xarm7_scenes import ARM, LAG, angles_down  # noqa: E402

PYTHON = python_with(ENVIRONMENT, PACKAGES)
if pathlib.Path(sys.prefix).resolve() != pathlib.Path(ENVIRONMENT).resolve():
    os.execv(PYTHON, [PYTHON, *sys.argv])

import mujoco  # noqa: E402
import numpy as np  # noqa: E402

RATE = 30  # Hz, of all four tasks
FAR = (0, 0.5, 0, 2, 0, 1.5, 0)  # rad: the arm stretched out, where it is slowest


class Arm:
    """The arm of a task without its object, in stock MuJoCo."""

    def __init__(self, task):
        self.model = mujoco.MjModel.from_xml_path(str(task / 'scene.xml'))
        self.steps = math.ceil(1 / RATE / self.model.opt.timestep - 1e-6)
        self.model.opt.timestep = 1 / RATE / self.steps
        self.data = mujoco.MjData(self.model)
        self.places = [self.model.joint(name).qposadr[0] for name in ARM]
        self.servos = [self.model.actuator(name).id for name in ARM]

    def hand(self, angles):
        self.data.qpos[self.places] = angles
        mujoco.mj_kinematics(self.model, self.data)
        return self.data.site('hand').xpos.copy()

    def follow(self, start, commands):
        """The angles after each step, from rest at `start`; a command lasts a frame."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self.places] = start
        way = [self.data.qpos[self.places].copy()]
        for command in commands:
            self.data.ctrl[self.servos] = command
            for _ in range(self.steps):
                mujoco.mj_step(self.model, self.data)
                way.append(self.data.qpos[self.places].copy())
        return np.array(way)


def to_joints(robot, task):
    """Actions of joints, a row a frame, with which the hand does what it did in an episode:
    `robot` has its poses and the gripper. A command stands for the middle of its frame, and is as
    much ahead as the servos lag."""
    settings = json.loads((task / 'task.json').read_text())['robot']
    yaw = np.unwrap(2 * np.arctan2(robot[:, 6], robot[:, 3]))
    angles = np.array([angles_down(*place, turn) for place, turn in zip(robot[:, :3], yaw)])
    turns = round((settings['home'][6] - angles[0, 6]) / (2 * math.pi))
    angles[:, 6] += 2 * math.pi * turns
    frames = np.arange(len(robot))
    columns = [np.interp(frames[:-1] + 0.5 + LAG * RATE, frames, angle) for angle in angles.T]
    for opened, closed in zip(settings.get('open', []), settings.get('closed', [])):
        columns.append(opened + robot[1:, 7] * (closed - opened))
    return np.stack(columns, axis=1)


def rollout(task, policy, folder, *options):
    """Verdict and arrays of each episode."""
    done = subprocess.run([PHYSPRING, 'rollout', task, '--level', '3', '--policy', policy,
                           '-o', folder, *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [(json.loads(file.with_suffix('.json').read_text()), np.load(file))
            for file in sorted((folder / 'level3').glob('*.npz'))]


class XArm7JointsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def actions_file(self, actions):
        np.savez(self.folder / 'actions.npz', actions=actions)
        return f'replay:{self.folder}/actions.npz'

    def test_home_is_that_of_the_hand(self):
        for task in TASKS:
            x, y, z, qw, *_, qz, _ = json.loads(
                (PROJECT / 'models/scenes' / task / 'task.json').read_text())['robot']['home']
            arm = Arm(PROJECT / '.deps/xarm7_joints' / task)
            mujoco.mj_kinematics(arm.model, arm.data)
            site = arm.data.site('hand')
            yaw = 2 * math.atan2(qz, qw)
            # the link lengths are those of the MJCF, so only rounding is left
            np.testing.assert_allclose(site.xpos, [x, y, z], atol=1e-9)
            np.testing.assert_allclose(site.xmat.reshape(3, 3)[:, 0],
                                       [math.cos(yaw), math.sin(yaw), 0], atol=1e-6)

    def test_steps_are_followed_without_overshoot(self):
        arm = Arm(ROPE)
        arm.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        home = json.loads((ROPE / 'task.json').read_text())['robot']['home'][:7]
        overshoot = settling = error = 0
        for start in (np.array(home), np.array(FAR)):
            for moved in [*np.eye(7), np.ones(7)]:
                for step in (0.2, -0.2):  # rad
                    way = arm.follow(start, [start + step * moved] * 60) - start
                    way = way[:, moved > 0] / step
                    overshoot = max(overshoot, way.max() - 1)
                    settling = max(settling, np.nonzero(abs(way - 1) > 0.02)[0].max() + 1)
                    error = max(error, abs(way[-1] - 1).max() * abs(step))
        settling *= arm.model.opt.timestep
        print(f'steps of 0.2 rad: overshoot {100 * overshoot:.2f} %, within 2 % after '
              f'{settling:.3f} s, then {error:.1e} rad off')
        self.assertLess(overshoot, 0.005)
        self.assertLess(settling, 5 * LAG)  # ln 50 = 4 time constants, and the motors' limit
        self.assertLess(error, 1e-4)

    def test_ramps_are_followed_with_the_lag_that_is_told(self):
        arm = Arm(ROPE)
        arm.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        home = json.loads((ROPE / 'task.json').read_text())['robot']['home'][:7]
        lags, beyond = [], 0
        for start in (np.array(home), np.array(FAR)):
            for moved in [*np.eye(7), np.ones(7)]:
                for speed in (1, -1):  # rad/s
                    ramp = np.minimum(np.arange(1, 49), 18) / RATE
                    way = arm.follow(start, start + speed * np.outer(ramp, moved)) - start
                    way = way[:, moved > 0] * speed
                    time = np.arange(len(way)) * arm.model.opt.timestep
                    steady = (time > 0.4) & (time <= 0.6)
                    # each reaches the line at its frame's end, so in the mean they are ahead of it
                    behind = (time[:, None] - way)[steady].mean(axis=0) + 0.5 / RATE
                    lags += list(behind)
                    beyond = max(beyond, way.max() - ramp[-1])
        print(f'ramps of 1 rad/s: {1000 * min(lags):.1f} to {1000 * max(lags):.1f} ms behind, '
              f'{beyond:.1e} rad beyond their end')
        self.assertLess(max(abs(lag - LAG) for lag in lags), 0.004)  # the motors' limit, once more
        self.assertLess(beyond, 1e-3)

    def test_what_the_hand_did_succeeds_as_joint_angles(self):
        for name in TASKS:
            task = PROJECT / '.deps/xarm7_joints' / name
            arm = Arm(task)
            kept = rollout(PROJECT / '.deps/xarm7' / name, 'scripted', self.folder / name / 'weld',
                           '--episodes', str(EPISODES))
            successes, gaps = [], []
            for k, (verdict, arrays) in enumerate(kept):
                actions = self.actions_file(to_joints(arrays['robot'], task))
                [(own, driven)] = rollout(task, actions, self.folder / name / f'joints{k}',
                                          '--first', str(k))
                self.assertEqual(own['start'], verdict['start'])
                self.assertEqual(own['problem'], '')
                successes.append((verdict['success'], own['success']))
                hand = np.array([arm.hand(angles) for angles in driven['robot'][:, :7]])
                gaps.append(np.linalg.norm(hand - arrays['robot'][:, :3], axis=1))
            print(f'{name}: weld {sum(a for a, _ in successes)}, joints '
                  f'{sum(b for _, b in successes)} of {EPISODES}; the hand is '
                  f'{1000 * np.mean(gaps):.2f} mm from its way, at most {1000 * np.max(gaps):.1f}')
            self.assertEqual([a for a, _ in successes], [b for _, b in successes])
            self.assertLess(np.mean(gaps), 0.001)  # m; 5 mm without the lag's compensation
            if name == 'rope_routing':
                self.assertTrue(all(b for _, b in successes))

    def test_it_holds_still_with_the_rope_in_its_fingers(self):
        [(_, arrays)] = rollout(PROJECT / '.deps/xarm7/rope_routing', 'scripted',
                                self.folder / 'weld')
        arm = Arm(ROPE)
        for held, what in ((74, 'gripped'), (102, 'lifted')):  # frames of the scripted policy
            actions = to_joints(arrays['robot'], ROPE)[:held]  # the last one is held
            [(_, driven)] = rollout(ROPE, self.actions_file(actions), self.folder / what)
            hand = np.array([arm.hand(q[:7]) for q in driven['robot'][held + 30:held + 120]])
            moves = np.ptp(hand, axis=0).max()
            off = np.linalg.norm(hand - arm.hand(actions[-1, :7]), axis=1).max()
            print(f'the rope is {what}: the hand moves by {1e6 * moves:.1f} um in 3 s, '
                  f'{1e6 * off:.0f} um from its command')
            self.assertLess(moves, 5e-5)  # m
            self.assertLess(off, 2e-4)

    def test_random_drives_it_and_scripted_is_refused(self):
        [(verdict, _)] = rollout(ROPE, 'random', self.folder / 'random')
        self.assertEqual(verdict['problem'], '')
        done = subprocess.run([PHYSPRING, 'rollout', ROPE, '--level', '3'], capture_output=True,
                              text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("key 'policy' holds ''", done.stderr)

    def test_droid_drives_it(self):
        log = self.folder / 'log.npz'
        server = [PYTHON, PROJECT / 'tests/rollout/openpi_policies_server.py', 'droid', log]
        with subprocess.Popen(server, stdout=subprocess.PIPE, text=True) as serving:
            try:
                address = f'ws://127.0.0.1:{int(serving.stdout.readline())}'
                [(verdict, arrays)] = rollout(ROPE, address, self.folder / 'droid',
                                              '--policy-adapter',
                                              PROJECT / 'models/adapters/openpi_droid.json')
            finally:
                serving.kill()
        robot, actions, asked = arrays['robot'], arrays['actions'], np.load(log)
        self.assertEqual(verdict['problem'], '')
        self.assertEqual(len(actions), verdict['frames'])
        np.testing.assert_allclose(asked['made:state'], [*robot[0, :7], robot[0, 7] / 0.04],
                                   atol=1e-9)
        for camera in ('base_0_rgb', 'left_wrist_0_rgb'):  # both see something
            self.assertGreater(asked['made:image:' + camera].std(), 10)
        # the server wants 0.5, and -1 after clipping, of 0.2 rad in two frames; the gripper closed
        for frame in range(0, 16, 2):
            np.testing.assert_allclose(actions[frame, :2] - robot[frame, :2], [0.1, -0.2],
                                       atol=1e-6)
            self.assertEqual(actions[frame, 7], 0.04)
        share = (robot[16, :2] - robot[2, :2]) / (7 * np.array([0.1, -0.2]))
        print(f'DROID: joints 1 and 2 move {share.round(2)} of what each action asks for; '
              f'gripper {robot[16, 7]:.3f} m')
        # counted from where the joints are, an action ends before the servos' lag does
        np.testing.assert_allclose(share, 1 - math.exp(-2 / RATE / LAG), atol=0.05)
        self.assertGreater(robot[16, 7], 0.035)
        np.testing.assert_allclose(robot[:, 2:7], np.tile(robot[0, 2:7], (len(robot), 1)), atol=0.1)


def main():
    for options in ([], ['--joints']):
        made = subprocess.run([PROJECT / 'scripts/xarm7', *options], stdout=subprocess.DEVNULL)
        if made.returncode != 0:
            sys.exit(77)
    unittest.main(argv=sys.argv[:1])


if __name__ == '__main__':
    main()
