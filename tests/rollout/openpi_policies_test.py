# SPDX-License-Identifier: Apache-2.0
"""The adapters of models/adapters against openpi's own code: its servers' transforms take what we
send, and its actions move our robots.

openpi_policies_test.py PHYSPRING MAKE_SMALL_TASK ADAPTERS ENVIRONMENT
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from python_environment import python_with

PHYSPRING, MAKE_TASK, ADAPTERS, ENVIRONMENT = sys.argv[1:]
PACKAGES = ['numpy<2', 'openpi-client==0.1.2', 'websockets>=14', 'einops']
HERE = pathlib.Path(__file__).parent


def arm(joints, fingers):
    """MJCF of an arm of hinges with servos, its hand at the end, and so many fingers on slides."""
    body, ends, servos = '', '', ''
    for i in range(joints):
        body += (f'<body pos="0 0 {0.03 if i else 0.5}"><joint name="j{i}" axis="{i % 2} '
                 f'{(i + 1) % 2} 0" damping="1" armature="0.1"/><geom size="0.01" mass="0.05" '
                 'contype="0" conaffinity="0"/>')
        ends += '</body>'
        servos += f'<position name="a{i}" joint="j{i}" kp="200" kv="20"/>'
    body += '<site name="hand"/><camera name="wrist" pos="0 0 0.1"/>'
    for i in range(fingers):
        body += (f'<body><joint name="f{i}" type="slide" axis="0 1 0" damping="1" armature="0.1"/>'
                 '<geom size="0.01" mass="0.05" contype="0" conaffinity="0"/></body>')
        servos += f'<position name="g{i}" joint="f{i}" kp="200" kv="20"/>'
    return body + ends, f'<actuator>{servos}</actuator>'


class PolicyAdapterTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.task = self.folder / 'task'
        self.log = self.folder / 'log.npz'
        subprocess.run([MAKE_TASK, self.task], check=True)
        self.change('scene.xml', '<camera name="top" pos="0.05 0.05 0.5"/>',
                    '<camera name="wrist" pos="0.05 0.05 0.5"/>')
        self.change('task.json', '["front", "top"]', '["front", "wrist"]')

    def change(self, name, old, new):
        text = (self.task / name).read_text()
        self.assertIn(old, text)
        (self.task / name).write_text(text.replace(old, new))

    def with_arm(self, joints, fingers):
        body, servos = arm(joints, fingers)
        self.change('scene.xml', '<camera name="wrist" pos="0.05 0.05 0.5"/>', body)
        self.change('scene.xml', '<site name="hand"/>\n    </body>', '</body>')
        self.change('scene.xml', '</mujoco>', servos + '</mujoco>')
        names = [f'a{i}' for i in range(joints)] + [f'g{i}' for i in range(fingers)]
        robot = {'kind': 'joints', 'actuators': names, 'hand': 'hand', 'home': [0.0] * len(names)}
        if fingers:
            robot.update(fingers=fingers, open=[0.0] * fingers, closed=[0.05] * fingers)
        self.change('task.json', '{"target": "target", "hand": "hand"}', json.dumps(robot))

    def with_finger(self):
        self.change('scene.xml', '<site name="hand"/>\n', '<site name="hand"/>\n<body><joint '
                    'name="f" type="slide" axis="0 1 0" damping="1" armature="0.1"/><geom size="0.01" '
                    'mass="0.05" contype="0" conaffinity="0"/></body>')
        self.change('scene.xml', '</mujoco>', '<actuator><position name="g" joint="f" kp="200" '
                    'kv="20"/></actuator></mujoco>')
        self.change('task.json', '"hand": "hand"}',
                    '"hand": "hand", "actuators": ["g"], "open": [0], "closed": [0.02]}')

    def rollout(self, name):
        """Arrays of the episode's file and the server's log, after a run against `name`."""
        command = [PYTHON, HERE / 'openpi_policies_server.py', name, self.log]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
            address = f'ws://127.0.0.1:{int(server.stdout.readline())}'
            adapter = f'{ADAPTERS}/openpi_{name}.json'
            done = subprocess.run([PHYSPRING, 'rollout', self.task, '--policy', address,
                                   '--policy-adapter', adapter, '-o', self.folder / 'out'],
                                  capture_output=True, text=True)
            server.kill()
        self.assertEqual(done.returncode, 0, done.stderr)
        kept = self.read(self.folder / 'out/level0/episode_00000.npz')
        return kept['robot'], kept['actions'], self.read(self.log)

    @staticmethod
    def read(path):
        code = ('import json, numpy, sys; a = numpy.load(sys.argv[1]); '
                'print(json.dumps({k: a[k].tolist() for k in a}))')
        done = subprocess.run([PYTHON, '-c', code, path], check=True, capture_output=True)
        return json.loads(done.stdout)

    def near(self, found, expected, delta):
        self.assertEqual(len(found), len(expected))
        for one, other in zip(found, expected):
            self.assertAlmostEqual(one, other, delta=delta)

    def test_libero_takes_our_hand_and_moves_it(self):
        self.with_finger()
        robot, actions, log = self.rollout('libero')
        state = log['made:state']
        # robosuite's table scenes have the robot's base there
        self.near(state[:3], [robot[0][0] - 0.66, robot[0][1], robot[0][2] + 0.912], 1e-9)
        self.near([abs(x) for x in state[3:6]], [math.pi, 0, 0], 1e-3)  # the tool looks down
        self.near(state[6:], [0.04, -0.04], 1e-3)  # open
        self.assertEqual(log['made:image_mask:right_wrist_0_rgb'], False)
        for frame, action in enumerate(actions):  # 0.1 of 0.05 m from where the hand is
            self.near(action[:3], [robot[frame][0], robot[frame][1] + 0.005, robot[frame][2]], 1e-8)
            self.assertEqual(action[7], 1)  # closed
        self.assertGreater(robot[-1][1], robot[0][1] + 0.02)

    def test_droid_takes_our_joints_and_moves_them(self):
        self.with_arm(7, 1)
        robot, actions, log = self.rollout('droid')
        self.near(log['made:state'], robot[0][:7] + [robot[0][7] / 0.05], 1e-9)
        self.near(actions[0][:3], [robot[0][0] + 0.1, robot[0][1] - 0.2, robot[0][2]], 1e-6)
        self.assertEqual(actions[0][7], 0.05)  # closed
        self.assertEqual(actions[1], actions[0])  # 15 Hz at 30
        self.near(actions[2][:1], [robot[2][0] + 0.1], 1e-6)
        self.assertGreater(robot[-1][0], 0.3)
        self.assertLess(robot[-1][1], -0.5)

    def test_aloha_takes_fourteen_joints_and_moves_them(self):
        self.with_arm(14, 0)
        robot, actions, log = self.rollout('aloha')
        self.near(log['made:state'], robot[0], 1e-9)
        self.assertEqual(log['made:image_mask:left_wrist_0_rgb'], True)
        self.near(actions[9], [q + 0.1 for q in robot[0]], 1e-6)
        self.near(actions[10], [q + 0.01 for q in robot[10]], 1e-6)  # the next chunk

    def test_pictures_are_resized_as_openpi_does(self):
        """With the task's own size, by openpi's own client code."""
        self.with_finger()
        _, _, log = self.rollout('libero')
        adapter = json.loads(pathlib.Path(f'{ADAPTERS}/openpi_libero.json').read_text())
        for field in adapter['request'].values():
            if isinstance(field, dict):
                del field['size']
        whole = self.folder / 'whole.json'
        whole.write_text(json.dumps(adapter))
        self.assertEqual(self.resized(whole), log['made:image:base_0_rgb'])

    def resized(self, adapter):
        """The first picture of a request that `adapter` leaves as large as the task draws it,
        resized by openpi-client."""
        code = '''
import asyncio, json, sys
import websockets.asyncio.server
from openpi_client import image_tools, msgpack_numpy
async def talk(connection):
    await connection.send(msgpack_numpy.Packer().pack({}))
    request = msgpack_numpy.unpackb(await connection.recv())
    picture = image_tools.resize_with_pad(request['observation/image'], 224, 224)
    print(json.dumps(picture.tolist()), flush=True)
async def main():
    async with websockets.asyncio.server.serve(talk, '127.0.0.1', 0) as running:
        print(running.sockets[0].getsockname()[1], flush=True)
        await asyncio.Future()
asyncio.run(main())'''
        with subprocess.Popen([PYTHON, '-c', code], stdout=subprocess.PIPE, text=True) as server:
            address = f'ws://127.0.0.1:{int(server.stdout.readline())}'
            with subprocess.Popen([PHYSPRING, 'rollout', self.task, '--policy', address,
                                   '--policy-adapter', adapter], stderr=subprocess.DEVNULL):
                picture = json.loads(server.stdout.readline())
            server.kill()
        return picture

    def test_another_adapter_is_another_sweep(self):
        self.with_finger()
        self.rollout('libero')
        other = self.folder / 'other.json'
        other.write_text(json.dumps({'request': {'p': 'prompt'}, 'action': ['robot']}))
        done = subprocess.run([PHYSPRING, 'rollout', self.task, '--policy', 'ws://127.0.0.1:1',
                               '--policy-adapter', other, '-o', self.folder / 'out'],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn('use another folder', done.stderr)


PYTHON = python_with(ENVIRONMENT, PACKAGES)
if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
