# SPDX-License-Identifier: Apache-2.0
"""`--policy ws://` against a server with openpi-client's own msgpack code.

websocket_policy_test.py PHYSPRING MAKE_SMALL_TASK ENVIRONMENT
"""
import itertools
import json
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from python_environment import python_with

PHYSPRING, MAKE_TASK, ENVIRONMENT = sys.argv[1:]
PACKAGES = ['numpy<2', 'openpi-client==0.1.2', 'websockets>=14']  # 0.1.2 wants numpy below 2
HERE = pathlib.Path(__file__).parent


class Server:
    """The server process, for `with`."""

    def __init__(self, behaviour, log, *port):
        self.command = [PYTHON, HERE / 'openpi_server.py', behaviour, log, *port]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True)
        return f'ws://127.0.0.1:{int(self.process.stdout.readline())}'

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()


class Restarted:
    """A server that is killed, or stops answering for a second, every 0.7 s, and comes up again."""

    def __init__(self, arguments):
        self.command = [PYTHON, HERE / 'openpi_server.py', *arguments]
        self.ended = threading.Event()
        self.thread = threading.Thread(target=self.run)

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()

    def run(self):
        for turn in itertools.count():
            with subprocess.Popen(self.command, stdout=subprocess.PIPE) as server:
                server.stdout.readline()
                self.ended.wait(0.7)
                if turn % 2 == 1:
                    server.send_signal(signal.SIGSTOP)
                    self.ended.wait(1)
                server.kill()
            if self.ended.is_set():
                return


class WebsocketPolicyTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.task = self.folder / 'task'
        self.log = self.folder / 'request.npz'
        subprocess.run([MAKE_TASK, self.task], check=True)

    def run_program(self, address, *options):
        report = self.folder / 'report.json'
        command = [PHYSPRING, 'rollout', self.task, '--policy', address, '--json', report, *options]
        return subprocess.run(command, capture_output=True, text=True), report

    def rollout(self, address, *options, status=0):
        """The report, and seconds."""
        start = time.monotonic()
        result, report = self.run_program(address, *options)
        self.assertEqual(result.returncode, status, result.stderr)
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
            episodes, _ = self.rollout(address, '--episodes', '2', status=1)
        self.assertEqual(len(episodes), 2)  # the sweep goes on
        for episode in episodes:
            self.assertFalse(episode['success'])
            self.assertIn(message, episode['problem'])

    def test_lying_servers_end_the_episode(self):
        self.check_problem('nan', 'not finite')
        self.check_problem('shape', 'have shape (7, 7), expected (n, 8)')

    def check_stop(self, behaviour, message, *options):
        """The sweep ends, and keeps no episode."""
        out = self.folder / behaviour
        with Server(behaviour, self.log) as address:
            result, _ = self.run_program(address, '--episodes', '2', '-o', out, *options)
        self.assertEqual(result.returncode, 1)
        self.assertIn(message, result.stderr)
        self.assertIn('episode 0 is not judged', result.stderr)
        self.assertEqual(list(out.glob('level0/episode*')), [])

    def test_failing_servers_stop_the_sweep(self):
        self.check_stop('text', "says 'KeyError: the policy failed'")
        self.check_stop('reason', "closed: 'the server restarts'")
        self.check_stop('dead', 'policy server 127.0.0.1')
        self.check_stop('garbage', 'not msgpack')  # not of the protocol: nothing of the policy

    def test_slow_server_stops_the_sweep_in_time(self):
        start = time.monotonic()
        self.check_stop('silent', 'does not answer within 2 s', '--first-patience', '2')
        self.assertLess(time.monotonic() - start, 30)

    def test_absent_server_stops_the_sweep(self):
        result, _ = self.run_program(f'ws://127.0.0.1:{free_port()}', '--server-wait', '1')
        self.assertEqual(result.returncode, 1)
        self.assertIn('Connection refused, for 1 s', result.stderr)

    def test_server_that_comes_up_late_is_waited_for(self):
        port = free_port()
        command = [PHYSPRING, 'rollout', self.task, '--policy', f'ws://127.0.0.1:{port}']
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE) as early:
            time.sleep(1)
            self.assertIsNone(early.poll())
            with Server('good', self.log, str(port)):
                self.assertEqual(early.wait(timeout=60), 0, early.stderr.read())

    def test_a_server_that_dies_hangs_and_restarts_costs_no_verdict(self):
        """30 episodes, the same command again and again: the files are those of an undisturbed run."""
        port, out, calm = str(free_port()), self.folder / 'out', self.folder / 'calm'
        options = ['--episodes', '30', '--patience', '0.5', '--first-patience', '0.5',
                   '--server-wait', '20']
        address = f'ws://127.0.0.1:{port}'
        failures = 0
        with Restarted(['late', self.log, port]):
            while True:
                result, _ = self.run_program(address, '-o', out, *options)
                if result.returncode == 0:
                    break
                failures += 1
                self.assertIn('is not judged, what was finished is kept', result.stderr)
                self.assertLess(failures, 100)
        self.assertGreater(failures, 3)
        with Server('good', self.log, port):
            self.rollout(address, '-o', calm, '--episodes', '30')
        for path in sorted(calm.glob('level0/episode_?????.*')):
            if not path.name.endswith('.seconds.json'):
                self.assertEqual((out / 'level0' / path.name).read_bytes(), path.read_bytes())
        self.assertEqual(len(list(out.glob('level0/episode_?????.json'))), 30)

    def test_pings_are_answered_while_a_chunk_runs(self):
        with Server('pings', self.log) as address:
            episodes, _ = self.rollout(address, '--episodes', '3')
        self.assertEqual([episode['problem'] for episode in episodes], ['', '', ''])
        pongs = pathlib.Path(f'{self.log}.pongs').read_text()
        self.assertEqual(pongs, 'pong\n' * 3)


def free_port():
    """One that nobody listens at."""
    with socket.socket() as free:
        free.bind(('127.0.0.1', 0))
        return free.getsockname()[1]


PYTHON = python_with(ENVIRONMENT, PACKAGES)
if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1])
