# SPDX-License-Identifier: Apache-2.0
"""Episodes of a task as a data set of LeRobot (v3), and back."""
from __future__ import annotations

import concurrent.futures
import dataclasses
import json
import os
import pathlib
import shutil
import threading
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from physpring import _core
from physpring._recordings import number, threads_of, whole

_META = 'meta/physpring.json'


@dataclasses.dataclass(frozen=True)
class RecordedEpisodes:
    """What `record` has written."""
    folder: pathlib.Path
    kept: list[int]  # numbers of the episodes, in the order of the data set
    run: int  # how many were simulated
    frames: int

    def __str__(self) -> str:
        return (f'{self.folder}: {len(self.kept)} of {self.run} episodes, {self.frames} frames; '
                'the others did not succeed' if len(self.kept) < self.run else
                f'{self.folder}: {len(self.kept)} episodes, {self.frames} frames')


@dataclasses.dataclass(frozen=True)
class _Wish:
    """What an episode is made of."""
    task: str
    level: int
    policy: str
    seed: int
    particles: int
    cameras: tuple[str, ...]
    size: int
    action_noise: float
    start_noise: float
    vary_looks: bool
    samples: tuple[str, ...]

    def env(self, episode: int = 0) -> Any:
        from physpring.envs import TaskEnv
        obs = 'pixels+particles+sensors' if self.cameras else 'particles+sensors'
        sample = self.samples[episode % len(self.samples)] if self.samples else ''
        return TaskEnv(self.task, self.level, obs=obs, action_noise=self.action_noise,
                       start_noise=self.start_noise, vary_looks=self.vary_looks, sample=sample)


def _dataset_class() -> Any:
    try:
        from lerobot.datasets.lerobot_dataset import LeRobotDataset  # type: ignore[import-not-found]
    except ImportError:
        raise _core.Error('lerobot is not installed, or older than 0.4: pip install lerobot') from None
    return LeRobotDataset


def _be_quiet() -> None:
    """No bar of progress for each episode, nor what the video encoder says of itself."""
    os.environ.setdefault('SVT_LOG', '1')
    import datasets  # type: ignore[import-not-found]
    datasets.disable_progress_bars()


def some_particles(particles: np.ndarray, count: int) -> np.ndarray:
    """(3 count,): `count` of (N, 3), evenly spaced by their numbers, as the part `particles` of a
    policy adapter has them; all for 0."""
    if count:
        particles = particles[np.arange(count) * len(particles) // count]
    return particles.reshape(-1)


def _look(wish: _Wish, seen: dict[str, Any]) -> dict[str, Any]:
    from physpring._mujoco import scenes
    frame = {'observation.state': seen['robot'].astype(np.float32)}
    if wish.particles >= 0:
        frame['observation.environment_state'] = some_particles(seen['particles'],
                                                                wish.particles).astype(np.float32)
    for name, reading in seen.get('sensors', {}).items():
        frame[f'observation.sensors.{name}'] = reading.astype(np.float32)
    for camera in wish.cameras:
        frame[f'observation.images.{camera}'] = scenes().resize_with_pad(
            seen['pixels'][camera], wish.size, wish.size)
    return frame


def _frames(wish: _Wish, episode: int,
            stop: threading.Event) -> tuple[int, bool, list[dict[str, Any]]]:
    """Number, verdict and frames of an episode; `stop` ends it."""
    env = wish.env(episode)
    seen, _ = env.reset(seed=wish.seed, options={'episode': episode})
    frames: list[dict[str, Any]] = []
    over = False
    info: dict[str, Any] = {}
    while not over:
        if stop.is_set():
            raise _core.Error('stopped')
        action = env.policy_action(wish.policy)
        frame = _look(wish, seen)
        seen, reward, _, over, info = env.step(action)
        frames.append({**frame, 'action': action.astype(np.float32),
                       'next.reward': np.array([reward], np.float32),
                       'next.success': np.array([info['is_success']]),
                       'next.done': np.array([over])})
    return episode, bool(info['is_success']), frames


def _features(wish: _Wish, frame: dict[str, Any]) -> dict[str, Any]:
    features: dict[str, Any] = {}
    for key, value in frame.items():
        if value.ndim == 3:
            features[key] = {'dtype': 'video', 'shape': value.shape,
                             'names': ['height', 'width', 'channels']}
        else:
            features[key] = {'dtype': str(value.dtype), 'shape': value.shape, 'names': None}
    if frame['action'].shape == (8,):
        pose = ['x', 'y', 'z', 'qw', 'qx', 'qy', 'qz', 'gripper']
        features['action']['names'] = features['observation.state']['names'] = pose
    return features


def record(task: str | os.PathLike,
           folder: str | os.PathLike,
           episodes: int = 100,
           *,
           level: int = 0,
           policy: str = 'scripted',
           seed: int = 0,
           particles: int = 32,
           cameras: Sequence[str] = (),
           size: int = 96,
           action_noise: float = 0,
           start_noise: float = 0,
           vary_looks: bool = False,
           samples: str | os.PathLike = '',
           keep: str = 'successes',
           threads: int | None = None) -> RecordedEpisodes:
    """Runs episodes 0, 1, ... of `physpring rollout --seed SEED` and writes those that succeed
    (keep='all': all of them) as a data set of LeRobot to the new folder `folder`.

    A frame has `observation.state` (the robot's state), `observation.environment_state` (so many
    particles of level 0 [m], evenly spaced; 0: all, -1: none), `observation.images.CAMERA` (size x
    size pixels, undistorted, with bars) for each of `cameras`, `action` as the task has it, and
    `next.reward`, `next.success`, `next.done`; for each of the task's sensors `observation.sensors.NAME`. What else is needed to run it again is in
    meta/physpring.json. vary_looks: each episode has other colours, lights and places of cameras.
    samples: folder of `physpring export --samples N`; episodes take its twins in turn. Nothing is left in `folder` if it fails.
    """
    from physpring._mujoco import task_folder
    if isinstance(cameras, str):
        cameras = [cameras]
    if keep not in ('successes', 'all'):
        raise _core.Error(f"keep is {keep!r}, expected 'successes' or 'all'")
    whole('episodes', episodes, 1)
    whole('size', size, 16, 4096)
    whole('particles', particles, -1)
    root = pathlib.Path(folder)
    if root.exists():
        raise _core.Error(f'{root}: is there already, expected a new folder')
    wish = _Wish(os.fspath(task_folder(task)), whole('level', level, 0), policy,
                 whole('seed', seed, 0), particles, tuple(cameras), size,
                 number('action_noise', action_noise, 0, 1),
                 number('start_noise', start_noise, 0, 1), bool(vary_looks), _folders(samples))
    env = wish.env()
    setting = env._setting.task
    whole('particles', particles, -1, setting.particle_count)
    if setting.rate != int(setting.rate):
        raise _core.Error(f'{wish.task}: rate is {setting.rate} Hz; LeRobot takes whole numbers')
    for camera in cameras:
        if camera not in setting.cameras:
            raise _core.Error(f'cameras has {camera!r}, expected some of {setting.cameras}')
    dataset_class = _dataset_class()  # takes seconds
    draft = root.with_name(root.name + '.part')
    shutil.rmtree(draft, ignore_errors=True)
    try:
        kept, frames = _write(dataset_class, draft, wish, env, episodes, keep, threads_of(threads))
        os.replace(draft, root)
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        raise
    return RecordedEpisodes(root, kept, episodes, frames)


def _folders(samples: str | os.PathLike) -> tuple[str, ...]:
    if not samples:
        return ()
    found = tuple(os.fspath(path.resolve()) for path in sorted(pathlib.Path(samples).glob('sample_*'))
                  if path.is_dir())
    if not found:
        raise _core.Error(f'{samples}: has no folders sample_0000, ...; `physpring export --samples` '
                          'makes them')
    return found


def _write(dataset_class: Any, draft: pathlib.Path, wish: _Wish, env: Any, episodes: int, keep: str,
           threads: int) -> tuple[list[int], int]:
    seen, _ = env.reset(seed=wish.seed)
    action = env.action_space.sample().astype(np.float32)
    example = {**_look(wish, seen), 'action': action, 'next.reward': np.zeros(1, np.float32),
               'next.success': np.zeros(1, bool), 'next.done': np.zeros(1, bool)}
    _be_quiet()
    dataset = dataset_class.create('physpring/' + pathlib.Path(wish.task).name,
                                   fps=int(env._setting.task.rate), root=draft,
                                   features=_features(wish, example), robot_type='physpring',
                                   use_videos=bool(wish.cameras))
    kept: list[int] = []
    count = 0
    stop = threading.Event()
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        try:
            for episode, success, frames in _in_order(pool, wish, episodes, threads, stop):
                if keep == 'successes' and not success:
                    continue
                for frame in frames:
                    dataset.add_frame({**frame, 'task': env.prompt})
                dataset.save_episode()
                kept.append(episode)
                count += len(frames)
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)
    if not kept:
        raise _core.Error(f'none of {episodes} episodes succeeded; nothing is written')
    dataset.finalize()
    story = {**dataclasses.asdict(wish), 'episodes': kept}
    (draft / _META).write_text(json.dumps(story, indent=1) + '\n')
    return kept, count


def _in_order(pool: Any, wish: _Wish, episodes: int, threads: int,
              stop: threading.Event) -> Iterator[Any]:
    """Episodes by their numbers, a few of them ahead."""
    running: list[Any] = []
    for episode in range(episodes):
        running.append(pool.submit(_frames, wish, episode, stop))
        if len(running) > threads:
            yield running.pop(0).result()
    for one in running:
        yield one.result()


def _recorded(root: pathlib.Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each frame: its episode, its action and whether the episode had succeeded."""
    dataset_class = _dataset_class()
    _be_quiet()
    try:
        table = dataset_class('physpring/replay', root=root).hf_dataset.with_format('numpy')
        index = np.asarray(table['episode_index'][:])
        actions = np.asarray(table['action'][:], float)
        return index, actions, np.asarray(table['next.success'][:]).reshape(len(index))
    except Exception as error:  # of many kinds, by what is damaged
        first = (str(error).splitlines() or [type(error).__name__])[0]
        raise _core.Error(f'{root}: is no data set that LeRobot reads: {first}') from error


@dataclasses.dataclass(frozen=True)
class ReplayedEpisode:
    """An episode of a data set that was run again."""
    episode: int  # its number in the sweep
    recorded: bool  # success, as recorded
    success: bool  # and now

    def __str__(self) -> str:
        return f'episode {self.episode}: {_word(self.success)}, recorded: {_word(self.recorded)}'


def _word(success: bool) -> str:
    return 'success' if success else 'no success'


def replay(folder: str | os.PathLike,
           *,
           task: str | os.PathLike | None = None,
           level: int | None = None) -> Iterator[ReplayedEpisode]:
    """Runs the actions of a data set that `record` wrote again, each episode from its own start, at
    the level they were recorded at or another one."""
    root = pathlib.Path(folder)
    try:
        story = json.loads((root / _META).read_text())
    except (OSError, ValueError) as error:
        raise _core.Error(f'{root / _META}: cannot be read: {error}') from None
    numbers = story.pop('episodes')
    wish = _Wish(**{**story, 'cameras': (), 'samples': tuple(story['samples'])})
    if task is not None:
        from physpring._mujoco import task_folder
        wish = dataclasses.replace(wish, task=os.fspath(task_folder(task)))
    if level is not None:
        wish = dataclasses.replace(wish, level=whole('level', level, 0))
    index, actions, successes = _recorded(root)
    if len(np.unique(index)) != len(numbers):
        raise _core.Error(f'{root}: has {len(np.unique(index))} episodes, but {_META} tells of '
                          f'{len(numbers)}')
    env = wish.env()
    for row, episode in enumerate(numbers):
        own = index == row
        if wish.samples:
            env = wish.env(episode)
        env.reset(seed=wish.seed, options={'episode': episode})
        info: dict[str, Any] = {}
        for action in actions[own]:
            *_, info = env.step(action)
        yield ReplayedEpisode(episode, bool(successes[own][-1]), bool(info['is_success']))
