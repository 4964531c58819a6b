#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A task of `physpring rollout` as an environment in stock MuJoCo, with Gymnasium's interface.

    python task_env.py TASK --level 0 --episode OUT/level0/episode_00000

runs the episode that `physpring rollout TASK -o OUT` has kept once more and says how far its states
are from those in C++. Needs the packages mujoco-core and numpy; and the engine plugin: installed
(docs/plugin.md), or named by the environment variable PHYSPRING_PLUGIN. It is written to be read and
changed: no line of it knows more than docs/rollout.md.
"""
import argparse
import json
import math
import os
import pathlib

import mujoco
import numpy as np

# As in rollout/pose.cc, operation by operation: a simulation with contacts is only the same in C++ and
# here if its input is, to the last bit.

def unit(q):
    """The unit quaternion along q, which must not be zero."""
    norm = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    if not 1e-3 <= norm < math.inf:
        raise ValueError(f'the quaternion {[float(x) for x in q]} is zero or not finite')
    return np.array([q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm])


def cosine_between(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


def angle_between(a, b):
    """The angle [rad] that turns one orientation into the other."""
    return 2 * math.acos(min(1.0, abs(cosine_between(a, b))))


def slerp(a, b, share):
    """Along the shortest turn from the first orientation (share 0) to the second (1)."""
    cosine = cosine_between(a, b)
    first, second = 1 - share, share
    if abs(cosine) < 1 - 1e-15:
        angle = math.acos(abs(cosine))
        first = math.sin((1 - share) * angle) / math.sin(angle)
        second = math.sin(share * angle) / math.sin(angle)
    if cosine < 0:
        second = -second
    return first * a + second * b


def turn(quaternion, vector):
    turned = np.empty(3)
    mujoco.mju_rotVecQuat(turned, vector, quaternion)
    return turned


def pose(fields):
    """Position [m] and unit quaternion w x y z of {"position": ..., "quaternion": ...}."""
    return (np.array(fields.get('position', [0, 0, 0]), dtype=float),
            unit(fields.get('quaternion', [1, 0, 0, 0])))


class TaskEnv:
    """reset() and step(action) as in gymnasium.Env; actions as docs/rollout.md describes them.

    An observation is {"robot": as in episodes' files, "nodes": (N, 3) places of the object's nodes
    [m]}. There is no reward: success is judged by `physpring rollout`. The same seed gives the same
    starts: the first, and those of later resets without a seed. An action that cannot be followed is
    a ValueError and changes nothing. A simulation that MuJoCo warns of, which it may silently start
    again, is a RuntimeError.
    """

    def __init__(self, folder, level=0):
        folder = pathlib.Path(folder)
        self.task = json.loads((folder / 'task.json').read_text())
        self.robot = self.task['robot']
        if self.robot.get('kind', 'cartesian') != 'cartesian':
            raise ValueError('this example drives robots of the kind cartesian')
        self.rate = self.task.get('rate', 30)
        self.frames = self.task['frames']
        self.settle = self.task.get('settle', 30)

        # the level goes into the scene, in a frame at the object's place
        scene = mujoco.MjSpec.from_file(str(folder / self.task.get('scene', 'scene.xml')))
        level_spec = mujoco.MjSpec.from_file(str(folder / self.task['levels'][level]))
        body = 'object_' + level_spec.worldbody.first_body().name
        self.object = pose(self.task.get('object', {}))
        scene.attach(level_spec, prefix='object_',
                     frame=scene.worldbody.add_frame(pos=self.object[0], quat=self.object[1]))
        self.model = scene.compile()
        self.steps = math.ceil(1 / self.rate / self.model.opt.timestep - 1e-6)
        self.model.opt.timestep = 1 / self.rate / self.steps
        self.data = mujoco.MjData(self.model)

        # the nodes: children of one fixed body, on three slide joints
        parent = self.model.body(body).id
        nodes = [child for child in range(parent + 1, self.model.nbody)
                 if self.model.body_parentid[child] == parent and self.model.body_jntnum[child] == 3]
        self.reference = self.model.body_pos[nodes].copy()
        first = self.model.jnt_qposadr[self.model.body_jntadr[nodes]]
        self.node_qpos = first[:, None] + np.arange(3)
        self.parent = self.model.body_pos[parent].copy(), self.model.body_quat[parent].copy()

        self.mocap = self.model.body(self.robot['target']).mocapid[0]
        self.hand = self.model.site(self.robot['hand']).id
        self.fingers = [self.model.actuator(name).id for name in self.robot.get('actuators', [])]
        self.open = np.array(self.robot.get('open', []), dtype=float)
        self.closed = np.array(self.robot.get('closed', []), dtype=float)
        self.random = np.random.default_rng()
        self.frame = None  # until the first reset

    def reset(self, *, seed=None, options=None):
        """options["start"]: where the object starts, as in an episode's JSON; else a random cell of
        the task's grid, drawn anew from `seed` or, without one, the next."""
        if seed is not None:
            self.random = np.random.default_rng(seed)
        start = (options or {}).get('start')
        if start:
            position, orientation = np.array(start['position']), np.array(start['quaternion'])
            unit(orientation)
        else:
            position, orientation = self._random_start()
        mujoco.mj_resetData(self.model, self.data)
        back = self.parent[1] * [1, -1, -1, -1]
        for reference, qpos in zip(self.reference, self.node_qpos):
            place = turn(orientation, reference) + position
            self.data.qpos[qpos] = turn(back, place - self.parent[0]) - reference
        self.frame = 0
        self.target = (self.data.mocap_pos[self.mocap].copy(),
                       unit(self.data.mocap_quat[self.mocap]), 0.0)
        self._place(*self.target)
        home = self.robot.get('home') or np.hstack(self.target)
        for _ in range(self.settle):
            self._run_frame(np.asarray(home, dtype=float))
        mujoco.mj_kinematics(self.model, self.data)
        return self._observe(), {}

    def step(self, action):
        """x y z [m], the quaternion w x y z of the target and the gripper, 0 open to 1 closed."""
        if self.frame is None:
            raise RuntimeError('reset() comes before step()')
        action = np.asarray(action, dtype=float)
        if action.shape != (8,) or not np.isfinite(action).all():
            raise ValueError('an action is 8 finite numbers: x y z, qw qx qy qz, gripper')
        self._run_frame(action)
        self.frame += 1
        return self._observe(), 0.0, False, self.frame >= self.frames, {}

    def _random_start(self):
        random = self.random
        starts = self.task.get('starts', {})
        shift = [random.choice(starts.get(axis, [0])) for axis in ('x', 'y')]
        noise = starts.get('noise_xy', 0.002)
        shift = np.array([*(shift + random.uniform(-noise, noise, 2)), 0])
        noise = starts.get('noise_yaw', 1)
        yaw = math.radians(random.choice(starts.get('yaw', [0])) + random.uniform(-noise, noise))
        orientation = np.empty(4)
        yaw = np.array([math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)])
        mujoco.mju_mulQuat(orientation, yaw, self.object[1])
        return self.object[0] + shift, orientation

    def _limit(self, position, quaternion, gripper):
        """The next target: no further from the last than the robot's speeds allow."""
        frame = 1 / self.rate

        def share(way, speed):
            return speed * frame / way if way > speed * frame else 1.0

        at, orientation, grip = self.target
        way = position - at
        angle = angle_between(orientation, quaternion)
        closing = min(max(gripper, 0.0), 1.0) - grip
        turn_speed = math.radians(self.robot.get('turn_speed', 180))
        return (at + share(mujoco.mju_norm3(way), self.robot.get('speed', 0.5)) * way,
                slerp(orientation, quaternion, share(angle, turn_speed)),
                grip + share(abs(closing), self.robot.get('gripper_speed', 2)) * closing)

    def _place(self, position, quaternion, gripper):
        self.data.mocap_pos[self.mocap] = position
        self.data.mocap_quat[self.mocap] = quaternion
        self.data.ctrl[self.fingers] = self.open + gripper * (self.closed - self.open)

    def _run_frame(self, action):
        position, quaternion, gripper = self.target
        to = self._limit(action[:3], unit(action[3:7]), action[7])
        for step in range(1, self.steps + 1):
            share = step / self.steps
            self._place(position + share * (to[0] - position),
                        slerp(quaternion, to[1], share), gripper + share * (to[2] - gripper))
            mujoco.mj_step(self.model, self.data)
            self._expect_no_warning()
        self.target = to
        mujoco.mj_kinematics(self.model, self.data)

    def _expect_no_warning(self):
        """MuJoCo counts its warnings, and after some starts again from the model's first state."""
        for kind, warning in enumerate(self.data.warning):
            if warning.number:
                self.frame = None
                name = mujoco.mjtWarning(kind).name
                raise RuntimeError(f'MuJoCo warns: {name}, {warning.lastinfo}; needs a reset()')

    def _observe(self):
        local = self.reference + self.data.qpos[self.node_qpos]
        nodes = np.array([turn(self.parent[1], node) for node in local]) + self.parent[0]
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, self.data.site_xmat[self.hand])
        robot = np.hstack([self.data.site_xpos[self.hand], quaternion, self.target[2]])
        return {'robot': robot, 'nodes': nodes}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('task', help='folder with task.json')
    parser.add_argument('--level', type=int, default=0)
    parser.add_argument('--episode', required=True, help='file of an episode, without its ending')
    arguments = parser.parse_args()
    if os.environ.get('PHYSPRING_PLUGIN'):
        mujoco.mj_loadPluginLibrary(os.environ['PHYSPRING_PLUGIN'])

    env = TaskEnv(arguments.task, arguments.level)
    verdict = json.loads(pathlib.Path(arguments.episode + '.json').read_text())
    arrays = np.load(arguments.episode + '.npz')
    observation, _ = env.reset(options={'start': verdict['start']})
    observations = [observation]
    for action in arrays['actions']:
        observations.append(env.step(action)[0])
    nodes = max(np.abs(o['nodes'] - kept).max() for o, kept in zip(observations, arrays['nodes']))
    robot = max(np.abs(o['robot'] - kept).max() for o, kept in zip(observations, arrays['robot']))
    moved = np.abs(observations[-1]['nodes'] - observations[0]['nodes']).max()
    print(f'{len(arrays["actions"])} frames; the object moved by up to {moved:.3g} m; '
          f'states differ by up to {max(nodes, robot):.3g}')
    return 0 if max(nodes, robot) < 1e-9 else 1


if __name__ == '__main__':
    raise SystemExit(main())
