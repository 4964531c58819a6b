# SPDX-License-Identifier: Apache-2.0
"""Many pieces of work on many workers, through any concurrent.futures.Executor."""
from __future__ import annotations

import concurrent.futures
import dataclasses
import html
import json
import multiprocessing
import os
import pathlib
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from physpring import _core
from physpring._mujoco import adapter_file, scenes, task_folder
from physpring._recordings import RecordingLike, number, recordings_of, seed_of, threads_of, whole
from physpring._training import train
from physpring._warnings import warn

_TRIES = 3  # of a piece of work whose worker is lost





@dataclasses.dataclass(frozen=True)
class Sweep:
    """The report of a sweep, that of `physpring rollout` or `merge`. `print` shows its tables."""
    json: str
    text: str
    folder: pathlib.Path | None  #: where the episodes are kept

    def to_dict(self) -> dict[str, Any]:
        """What `--json` writes (docs/rollout.md)."""
        return json.loads(self.json)

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return f'<pre>{html.escape(self.text)}</pre>'


def sweep(task: str | os.PathLike,
          policy: str = 'scripted',
          episodes: int = 1,
          levels: Sequence[int] = (0,),
          *,
          policy_adapter: str | os.PathLike = '',
          executor: concurrent.futures.Executor | None = None,
          workers: int | None = None,
          output: str | os.PathLike | None = None,
          first: int = 0,
          seed: int = 0,
          action_noise: float = 0,
          start_noise: float = 0,
          states: bool = True,
          callback: Callable[[float, str], Any] | None = None) -> Sweep:
    """Runs a policy on a task, episode after episode, at one or more levels.

    It is `physpring rollout`, spread over workers: every episode depends on the task, the policy,
    the seed and its number only, so the report is the same however many workers there are.

    task: one of physpring.envs ('rope_routing'), or a folder, which workers on other machines must
        have at the same path. policy: 'scripted', 'random', 'replay:PATH' or 'ws://HOST:PORT'.
    policy_adapter: for a 'ws://' policy: one of this package ('lerobot_state', 'openpi_libero', ...),
        or a file, as of `physpring rollout --policy-adapter`.
    executor: any concurrent.futures.Executor, as that of a Dask client (client.get_executor()) or of
        Ray; physpring must be installed on the workers. None: processes of this machine, `workers`
        of them (None: all cores). An episode whose worker is lost is run again, on those that are
        left.
    output: folder for the episodes, as of `physpring rollout -o`: a sweep that was stopped goes on.
        None: they are not kept.
    callback: is called with the share of the episodes that are done and what was done last.
    """
    whole('episodes', episodes, 1)
    whole('first', first, 0)
    number('action_noise', action_noise, 0, 1)
    number('start_noise', start_noise, 0, 1)
    seed_of(seed)
    if isinstance(levels, str) or not isinstance(levels, Iterable):
        raise _core.Error(f'levels is {levels!r}, expected a list of whole numbers')
    levels = [whole('level', level, 0) for level in levels]
    if len(set(levels)) != len(levels) or not levels:
        raise _core.Error(f'levels is {levels}, expected different ones')
    job = {'task': os.fspath(task_folder(task).resolve()), 'policy': policy, 'levels': levels,
           'policy_adapter': adapter_file(policy_adapter),
           'seed': seed, 'action_noise': action_noise, 'start_noise': start_noise, 'states': states}
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary if output is None else output)
        warn(_run(job, folder, first, 0))  # makes the folder, or says what is wrong with it
        jobs = {number: (job, number) for number in range(first, first + episodes)
                if not _is_kept(folder, levels, number)}
        done = episodes - len(jobs)
        _tell(callback, done, episodes)
        for _, files in _spread(_episode, jobs, executor, workers):
            _keep(folder, files)
            done += 1
            _tell(callback, done, episodes)
        report, text = scenes().report([os.fspath(folder)])
    return Sweep(report, text, None if output is None else folder)


def train_many(recordings: Mapping[str, RecordingLike | Iterable[RecordingLike]],
               *,
               executor: concurrent.futures.Executor | None = None,
               workers: int | None = None,
               output: str | os.PathLike | None = None,
               callback: Callable[[float, str], Any] | None = None,
               **options: Any) -> dict[str, _core.Twin]:
    """A twin of each of many objects: `train`, spread over workers as `sweep` is.

    recordings: of each object, by its name. output: folder for NAME.twin.npz; twins that are there
    already, of the same recordings, are not trained again, whatever the options. options: those of
    `train`.
    """
    folder = None if output is None else pathlib.Path(output)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
    twins: dict[str, _core.Twin] = {}
    jobs = {}
    for name, given in recordings.items():
        of_object = recordings_of(given, 'fit')
        if folder is not None and (folder / f'{name}.twin.npz').exists():
            twins[name] = _twin_of(of_object, folder / f'{name}.twin.npz')
        else:
            jobs[name] = (name, of_object, options)
    _tell(callback, len(twins), len(recordings))
    with tempfile.TemporaryDirectory() as temporary:
        for name, content in _spread(_train, jobs, executor, workers):
            path = (folder or pathlib.Path(temporary)) / f'{name}.twin.npz'
            _write(path, content)
            twins[name] = _core.Twin.load(path)
            _tell(callback, len(twins), len(recordings))
    return {name: twins[name] for name in recordings}


def _spread(work: Callable[..., Any], jobs: Mapping[Any, tuple], executor: Any,
            workers: int | None) -> Iterator[tuple[Any, Any]]:
    """The results of work(*jobs[key]) with their keys, as they come. Where a worker is lost, its
    work is given out again; what the work raises itself goes on."""
    if not jobs:
        return
    if executor is not None:
        yield from _collect(work, dict(jobs), lambda: executor, lambda: None)
        return
    pool: list[concurrent.futures.ProcessPoolExecutor] = []
    # a fork would take over threads in the middle of something
    context = multiprocessing.get_context('spawn')

    def get() -> concurrent.futures.Executor:
        if not pool:
            pool.append(concurrent.futures.ProcessPoolExecutor(threads_of(workers, 'workers'), context))
        return pool[0]

    def renew() -> None:  # a pool that lost a process takes no work any more
        pool.pop().shutdown(wait=False, cancel_futures=True)

    try:
        yield from _collect(work, dict(jobs), get, renew)
    finally:
        if pool:
            pool[0].shutdown(cancel_futures=True)


def _collect(work: Callable[..., Any], jobs: dict[Any, tuple], get: Callable[[], Any],
             renew: Callable[[], None]) -> Iterator[tuple[Any, Any]]:
    for _ in range(_TRIES):
        futures = {get().submit(work, *job): key for key, job in jobs.items()}
        lost = None
        for future in concurrent.futures.as_completed(futures):
            try:
                result = future.result()
            except Exception as error:  # pylint: disable=broad-except
                if not _is_loss(error):
                    for other in futures:
                        other.cancel()
                    raise
                lost = error
                continue
            del jobs[futures[future]]
            yield futures[future], result
        if lost is None:
            return
        renew()
    raise _core.Error(f'the workers of {len(jobs)} pieces of work were lost {_TRIES} times: {lost}')


def _is_loss(error: Exception) -> bool:
    """Whether it tells of a lost worker, and not of the work."""
    if isinstance(error, (concurrent.futures.BrokenExecutor, concurrent.futures.CancelledError)):
        return True
    return type(error).__name__ in ('KilledWorker', 'WorkerCrashedError', 'NodeDiedError',
                                    'FutureCancelledError', 'CommClosedError')


def _tell(callback: Callable[[float, str], Any] | None, done: int, count: int) -> None:
    if callback is not None:
        callback(done / count, f'{done} of {count}')


# what workers do

def _episode(job: Mapping[str, Any], number: int) -> dict[str, bytes]:
    """The files of an episode at all levels."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        _run(job, root, number, 1)
        return {path.relative_to(root).as_posix(): path.read_bytes()
                for path in sorted(root.rglob('*')) if path.is_file()}


def _run(job: Mapping[str, Any], folder: pathlib.Path, first: int, episodes: int) -> list[str]:
    """Episodes of a job, into a folder. Returns warnings of the task."""
    _, lines = scenes().sweep(job['task'], os.fspath(folder), job['levels'], job['policy'],
                              job['policy_adapter'], first, episodes, job['seed'],
                              job['action_noise'], job['start_noise'], 1, job['states'])
    return lines


def _train(name: str, given: list[_core.Recording], options: dict[str, Any]) -> bytes:
    """The file of a twin."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / f'{name}.twin.npz'
        train(given, output=path, **{'threads': 1, **options})
        return path.read_bytes()


# what is kept

def _twin_of(recordings: list[_core.Recording], path: pathlib.Path) -> _core.Twin:
    """A twin that was trained before."""
    twin = _core.Twin.load(path)
    if [one for _, one in twin.trained_on] != [one.hash for one in recordings]:
        raise _core.Error(f'{path}: is a twin of other recordings; choose another folder')
    return twin


def _is_kept(folder: pathlib.Path, levels: Sequence[int], number: int) -> bool:
    """Whether an episode is there and whole, at all levels."""
    try:
        return all(scenes().is_finished(os.fspath(folder), level, number) for level in levels)
    except _core.Error as error:
        warn([f'{error}; the episode is run again'])
        return False


def _keep(folder: pathlib.Path, files: Mapping[str, bytes]) -> None:
    """Puts an episode's files beside those of the others; they are of one and the same sweep."""
    def verdict_last(name: str) -> tuple[bool, str]:
        return name.endswith('.json') and not name.endswith('.seconds.json'), name

    for name in sorted(files, key=verdict_last):
        path = folder / name
        if path.exists() and not path.name.startswith('episode_'):
            if path.read_bytes() != files[name]:
                raise _core.Error(f'{path}: is of another sweep; choose another folder')
            continue
        _write(path, files[name])


def _write(path: pathlib.Path, content: bytes) -> None:
    """Whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f'.{path.name}.{os.getpid()}')
    try:
        draft.write_bytes(content)
        shutil.move(draft, path)
    finally:
        draft.unlink(missing_ok=True)
