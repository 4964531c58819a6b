# SPDX-License-Identifier: Apache-2.0
"""LeRobot's policies in PhySPRING's tasks, and PhySPRING's episodes in LeRobot's data sets.

    python -m physpring.lerobot record rope_routing demos --episodes 100    # a data set (v3)
    lerobot-train --policy.type=act --dataset.root=demos ...                # LeRobot's own program
    python -m physpring.lerobot serve CHECKPOINT --port 8000                # its policy, served
    physpring rollout TASK --policy ws://127.0.0.1:8000 \
        --policy-adapter models/adapters/lerobot_state.json
    python -m physpring.lerobot replay demos                                # its episodes, again

Needs lerobot (0.4 or later, with PyTorch: pip install lerobot), and for `serve` msgpack and
websockets. Policies are served in openpi's protocol, because that of LeRobot's own servers is of
pickled classes, which only Python can make and only trusted senders should.
"""
from __future__ import annotations

import argparse
import asyncio
import functools
import os
import pathlib
import threading
from typing import Any

import numpy as np

from physpring import _core
from physpring._lerobot_data import record, replay

__all__ = ['LeRobotPolicy', 'PolicyServer', 'record', 'replay', 'serve']

_MOST_BYTES = 1 << 26


def _pack(array: Any) -> Any:
    """For msgpack, as openpi-client has it (msgpack_numpy.py)."""
    if isinstance(array, np.ndarray):
        return {b'__ndarray__': True, b'data': array.tobytes(), b'dtype': array.dtype.str,
                b'shape': array.shape}
    return array


def _unpack(item: dict[Any, Any]) -> Any:
    if b'__ndarray__' in item:
        return np.frombuffer(item[b'data'], np.dtype(item[b'dtype'])).reshape(item[b'shape'])
    return item


def _needed(name: str) -> Any:
    try:
        return __import__(name)
    except ImportError:
        raise _core.Error(f'{name} is not installed: pip install {name}') from None


class LeRobotPolicy:
    """A checkpoint of LeRobot (a folder, or a name USER/MODEL on its hub): requests in, chunks of
    actions out.

    device: 'cpu', 'cuda', ...; threads: of PyTorch, where it runs on a CPU.
    """

    def __init__(self, checkpoint: str | os.PathLike, device: str = 'cpu', threads: int = 1):
        name = os.fspath(checkpoint)
        is_folder = pathlib.Path(name).is_dir()
        if not is_folder and name.count('/') != 1:
            raise _core.Error(f'{name}: is no folder with a checkpoint, nor a name USER/MODEL')
        if is_folder and not (pathlib.Path(name) / 'config.json').exists():
            raise _core.Error(f'{name}: has no config.json, as a checkpoint of LeRobot has')
        try:
            self._load(name, device, threads)
        except _core.Error:
            raise
        except Exception as error:  # of many kinds
            first = (str(error).splitlines() or [type(error).__name__])[0]
            raise _core.Error(f'{name}: is no checkpoint that LeRobot loads: {first}') from error

    def _load(self, name: str, device: str, threads: int) -> None:
        torch = _needed('torch')
        _needed('lerobot')
        from lerobot.configs.policies import PreTrainedConfig  # type: ignore[import-not-found]
        from lerobot.policies.factory import (  # type: ignore[import-not-found]
            get_policy_class, make_pre_post_processors)
        torch.set_num_threads(threads)
        config = PreTrainedConfig.from_pretrained(name)
        config.device = device
        self.policy = get_policy_class(config.type).from_pretrained(name, config=config)
        self.policy.to(device).eval()
        self.inputs: dict[str, Any] = dict(config.input_features)
        processors = make_pre_post_processors(
            config, pretrained_path=name,
            preprocessor_overrides={'device_processor': {'device': device}})
        self._before, self._after = processors
        self._lock = threading.Lock()

    def actions(self, request: dict[str, Any]) -> np.ndarray:
        """(n, A): the actions that the policy wants from here on. request: by LeRobot's names;
        `observation.images.*` as (height, width, 3) of uint8. ValueError where one is missing."""
        import torch
        missing = sorted(set(self.inputs) - set(request))
        if missing:
            raise ValueError(f'the request has no {missing[0]!r}; the policy was trained with '
                             + ', '.join(sorted(self.inputs)))
        batch: dict[str, Any] = {}
        for key in self.inputs:
            value = torch.from_numpy(np.array(request[key]))
            if value.ndim == 3:
                value = value.permute(2, 0, 1).float() / 255
            batch[key] = value.float()[None]
        if 'task' in request:
            batch['task'] = [request['task']]
        with self._lock, torch.no_grad():
            chunk = self.policy.predict_action_chunk(self._before(batch))
            return self._after(chunk)[0].cpu().numpy().astype(np.float32)


class PolicyServer:
    """Serves a policy in openpi's protocol, in a thread of its own.

        with PolicyServer(LeRobotPolicy('checkpoint')) as address:    # 'ws://127.0.0.1:PORT'
            physpring.sweep(task, policy=address, ...)

    policy: anything with actions(request) -> (n, A). port 0: a free one.
    """

    def __init__(self, policy: Any, host: str = '127.0.0.1', port: int = 0):
        self._policy, self._host, self._port = policy, host, port
        self._loop = asyncio.new_event_loop()
        self._ready, self._thread = threading.Event(), threading.Thread(target=self._run, daemon=True)
        self._failure: Exception | None = None

    def __enter__(self) -> str:
        self._thread.start()
        self._ready.wait()
        if self._failure is not None:
            raise self._failure
        return f'ws://{self._host}:{self._port}'

    def __exit__(self, *_: Any) -> None:
        self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join()

    def wait(self) -> None:
        """Until the process is stopped."""
        while self._thread.is_alive():
            self._thread.join(0.2)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        except Exception as error:  # told where it is waited for
            self._failure = error
        finally:
            self._ready.set()
            self._loop.close()

    async def _serve(self) -> None:
        _needed('websockets')
        from websockets.asyncio.server import serve as listen
        self._end = asyncio.Event()
        async with listen(self._talk, self._host, self._port, compression=None,
                          max_size=_MOST_BYTES) as running:
            self._port = next(iter(running.sockets)).getsockname()[1]
            self._ready.set()
            await self._end.wait()

    async def _talk(self, connection: Any) -> None:
        msgpack = _needed('msgpack')
        pack = functools.partial(msgpack.packb, default=_pack)
        await connection.send(pack({'server': 'physpring.lerobot'}))
        from websockets.exceptions import ConnectionClosed
        try:
            async for message in connection:
                await self._answer(connection, message, pack, msgpack)
        except ConnectionClosed:  # the client is gone, as after an episode
            pass

    async def _answer(self, connection: Any, message: bytes, pack: Any, msgpack: Any) -> None:
        request = msgpack.unpackb(message, object_hook=_unpack)
        try:
            actions = await asyncio.to_thread(self._policy.actions, request)
        except Exception as error:  # the client is to say what went wrong
            await connection.send(f'{type(error).__name__}: {error}')
            await connection.close(1011, 'the policy failed')
            return
        await connection.send(pack({'actions': actions}))


def serve(checkpoint: str | os.PathLike, host: str = '127.0.0.1', port: int = 8000,
          device: str = 'cpu', threads: int = 1) -> None:
    """Serves a checkpoint of LeRobot until it is stopped."""
    server = PolicyServer(LeRobotPolicy(checkpoint, device, threads), host, port)
    with server as address:
        print(f'serving {checkpoint} at {address}', flush=True)
        server.wait()


def _main() -> None:
    parser = argparse.ArgumentParser(prog='python -m physpring.lerobot',
                                     description=(__doc__ or '').split('\n')[0])
    commands = parser.add_subparsers(dest='command', required=True)
    recorder = commands.add_parser('record', help='episodes of a task -> a LeRobot data set',
                                   formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    recorder.add_argument('task')
    recorder.add_argument('folder', type=pathlib.Path)
    recorder.add_argument('--episodes', type=int, default=100, help='how many are run')
    recorder.add_argument('--level', type=int, default=0, help='of the twin; 0 is the slowest')
    recorder.add_argument('--policy', default='scripted', help='as of physpring rollout')
    recorder.add_argument('--seed', type=int, default=0, help='of starts and policies')
    recorder.add_argument('--particles', type=int, default=32,
                          help='so many in observation.environment_state; 0: all, -1: none')
    recorder.add_argument('--cameras', default='', help='names, with commas')
    recorder.add_argument('--size', type=int, default=96, help='of pictures, pixels')
    recorder.add_argument('--threads', type=int, help='episodes at once; default: all cores')
    recorder.add_argument('--action-noise', type=float, default=0.0,
                          help="m, of an error of the hand's place, constant in an episode")
    recorder.add_argument('--vary-looks', action='store_true',
                          help='other colours, lights and places of cameras in each episode')
    recorder.add_argument('--samples', default='', help='folder of physpring export --samples')
    recorder.add_argument('--all', action='store_true', help='also episodes that fail')
    server = commands.add_parser('serve', help='a policy, in the protocol of openpi')
    server.add_argument('checkpoint')
    server.add_argument('--host', default='127.0.0.1')
    server.add_argument('--port', type=int, default=8000)
    server.add_argument('--device', default='cpu')
    server.add_argument('--threads', type=int, default=1)
    again = commands.add_parser('replay', help='a data set in its task again')
    again.add_argument('folder', type=pathlib.Path)
    again.add_argument('--level', type=int)
    arguments = vars(parser.parse_args())
    command = arguments.pop('command')
    try:
        if command == 'record':
            arguments['cameras'] = [name for name in arguments['cameras'].split(',') if name]
            arguments['keep'] = 'all' if arguments.pop('all') else 'successes'
            print(record(**arguments))
        elif command == 'serve':
            serve(**arguments)
        else:
            for episode in replay(**arguments):
                print(episode)
    except _core.Error as error:
        raise SystemExit(f'physpring.lerobot: {error}') from None
    except KeyboardInterrupt:
        raise SystemExit(130) from None


if __name__ == '__main__':
    _main()
