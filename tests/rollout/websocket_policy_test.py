# SPDX-License-Identifier: Apache-2.0
"""`--policy ws://` against a server with openpi-client's own msgpack code.

websocket_policy_test.py PHYSPRING MAKE_SMALL_TASK ENVIRONMENT
"""
import json
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from python_environment import python_with

PHYSPRING, MAKE_TASK, ENVIRONMENT = sys.argv[1:]
PACKAGES = ['numpy<2', 'openpi-client==0.1.2', 'websockets>=14']  # 0.1.2 wants numpy below 2
HERE = pathlib.Path(__file__).parent


class Server:
    """The server process, for `with`."""

    def __init__(self, behaviour, log):
        self.command = [PYTHON, HERE / 'openpi_server.py', behaviour, log]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        return f'ws://127.0.0.1:{int(self.process.stdout.readline())}'

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


class WebsocketPolicyTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.task = self.folder / 'task'
        self.log = self.folder / 'request.npz'
        subprocess.run([MAKE_TASK, self.task], check=True)

    def rollout(self, address, *options):
        """The report, and seconds."""
        report = self.folder / 'report.json'
        start = time.monotonic()
        subprocess.run([PHYSPRING, 'rollout', self.task, '--policy', address, '--json', report,
                        *options],
                       check=True, stdout=subprocess.DEVNULL)
        seconds = time.monotonic() - start
        return json.loads(report.read_text())['policies'][0]['episodes'], seconds

    def read(self, path, name):
        """An array of a NumPy archive, by the environment's numpy, as nested lists."""
        code = 'import json, numpy, sys; print(json.dumps(numpy.load(sys.argv[1])[sys.argv[2]].tolist()))'
        done = subprocess.run([PYTHON, '-c', code, path, name], check=True, capture_output=True)
        return json.loads(done.stdout)

    def test_state_prompt_and_chunks_arrive_intact(self):
        with Server('good', self.log) as address:
            episodes, _ = self.rollout(address, '-o', self.folder / 'out')
        self.assertEqual(episodes[0]['problem'], '')
        kept = self.folder / 'out/level0/episode_00000.npz'
        robot, actions = self.read(kept, 'robot'), self.read(kept, 'actions')
        self.assertEqual(self.read(self.log, 'state'), robot[0])
        self.assertEqual(self.read(self.log, 'prompt'), 'push the block behind the line')
        for frame, action in enumerate(actions):  # each chunk starts from the state it was asked with
            chunk, row = frame // 7 * 7, frame % 7 + 1
            self.assertAlmostEqual(action[1], robot[chunk][1] + 0.008 * row, delta=1e-6)

    def test_images_arrive_intact(self):
        with Server('good', self.log) as address:
            self.rollout(address, '--video', self.folder / 'film_%04d.png', '--cameras', 'front')
        image = self.read(self.log, 'image_front')
        self.assertEqual((len(image), len(image[0]), len(image[0][0])), (48, 64, 3))
        drawn = subprocess.run(
            ['ffmpeg', '-loglevel', 'error', '-i', self.folder / 'film_0001.png', '-f', 'rawvideo',
             '-pix_fmt', 'rgb24', '-'], check=True, capture_output=True).stdout
        self.assertEqual(bytes(b for row in image for pixel in row for b in pixel), drawn)
        self.assertGreater(len(set(drawn)), 10)  # a picture of something
        self.assertNotEqual(self.read(self.log, 'image_top'), image)

    def check_problem(self, behaviour, message):
        with Server(behaviour, self.log) as address:
            episodes, seconds = self.rollout(address, '--episodes', '2', '--patience', '2')
        self.assertEqual(len(episodes), 2)  # the sweep goes on
        for episode in episodes:
            self.assertFalse(episode['success'])
            self.assertIn(message, episode['problem'])
        return seconds

    def test_lying_servers_end_the_episode(self):
        self.check_problem('nan', 'not finite')
        self.check_problem('shape', 'have shape (7, 7), expected (n, 8)')

    def test_failing_servers_end_the_episode(self):
        self.check_problem('text', 'Traceback: the policy failed')
        self.check_problem('garbage', 'not msgpack')
        self.check_problem('dead', 'policy server 127.0.0.1')

    def test_slow_server_ends_the_episode_in_time(self):
        self.assertLess(self.check_problem('silent', 'does not answer within 2 s'), 30)

    def test_absent_server_ends_the_episode(self):
        with socket.socket() as free:  # a port that nobody listens at
            free.bind(('127.0.0.1', 0))
            episodes, _ = self.rollout(f'ws://127.0.0.1:{free.getsockname()[1]}')
        self.assertIn('Connection refused', episodes[0]['problem'])


PYTHON = python_with(ENVIRONMENT, PACKAGES)
if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
