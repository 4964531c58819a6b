# SPDX-License-Identifier: Apache-2.0
"""Recordings from files, and what functions take for recordings."""
from __future__ import annotations

import numbers
import operator
import os
import pathlib
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from typing import Union

from physpring import _core

RecordingLike = Union[_core.Recording, str, os.PathLike]


def load_dataset(*paths: str | os.PathLike, role: str = 'fit') -> list[_core.Recording]:
    """The recordings of files, and of folders with a dataset.json (docs/files.md).

    role: of a folder's recordings, 'fit' for those to train on, 'heldout' for those to judge by.
    """
    return _core.load_dataset([os.fspath(path) for path in paths], role)


def record(scene: str | os.PathLike,
           output: str | os.PathLike | None = None,
           *,
           noise: float = 0,
           occlusion: float = 0,
           vary: float = 0,
           seed: int = 0,
           duration: float | None = None,
           fps: float = 30,
           effects: Mapping[str, float] | None = None) -> _core.Recording:
    """What a camera would measure of a soft body that MuJoCo simulates, as `physpring record` does.

    scene: MJCF with one soft body that mocap bodies move along the scene's keyframes
        (docs/record.md); or 'rope', 'cloth', 'block', 'cord', those of this package.
    output: file to write as well, NAME.npz.
    noise: standard deviation of each coordinate, m. occlusion: part of the points that is hidden in
    each frame. vary: keyframes are shifted by up to this, m: another motion for each seed. effects:
    what the scene gets, too, without a word in the recording: {'air_drag.wind_y_m_per_s': 2}.
    """
    from physpring._mujoco import OBJECTS, scenes  # pylint: disable=import-outside-toplevel
    own = pathlib.Path(scene)
    path = own if own.is_file() else OBJECTS / f'{own}.xml'
    if not path.exists():
        raise _core.Error(f'{scene}: is no file, nor one of '
                          f'{", ".join(sorted(one.stem for one in OBJECTS.glob("*.xml")))}')
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / f'{own.stem}.npz' if output is None else pathlib.Path(output)
        scenes().record(os.fspath(path), os.fspath(file), noise, occlusion, vary,
                        seed_of(seed), duration, fps,
                        dict(effects or {}))
        return _core.Recording.load(file)


def recordings_of(given: RecordingLike | Iterable[RecordingLike], role: str) -> list[_core.Recording]:
    """A recording, a path, or several of them, as a list of recordings."""
    if isinstance(given, (_core.Recording, str, os.PathLike)):
        given = [given]
    found: list[_core.Recording] = []
    for one in given if isinstance(given, Iterable) else [given]:
        if isinstance(one, _core.Recording):
            found.append(one)
        elif isinstance(one, (str, os.PathLike)):
            found += load_dataset(one, role=role)
        else:
            raise TypeError('a recording is a physpring.Recording or a path, not '
                            f'{type(one).__name__}; Recording.from_arrays takes arrays')
    return found


def twin_of(given: _core.Twin | str | os.PathLike) -> _core.Twin:
    """A twin, or that of a file."""
    if isinstance(given, _core.Twin):
        return given
    if isinstance(given, (str, os.PathLike)):
        return _core.Twin.load(given)
    raise TypeError(f'a twin is a physpring.Twin or a path, not {type(given).__name__}')


def whole(name: str, value: int, least: int, most: int = 2**31 - 1) -> int:
    """A whole number within bounds."""
    try:
        number = operator.index(value)
    except TypeError:
        raise _core.Error(f'{name} is {value!r}, expected a whole number') from None
    if not least <= number <= most:
        bounds = f'{least} or more' if number < least else f'at most {most}'
        raise _core.Error(f'{name} is {value}, expected {bounds}')
    return number


def seed_of(seed: int) -> int:
    """A seed of random numbers."""
    return whole('seed', seed, 0, 2**64 - 1)


def number(name: str, value: float, least: float, most: float) -> float:
    """A finite number within bounds."""
    if not isinstance(value, numbers.Real) or not least <= value <= most:
        raise _core.Error(f'{name} is {value!r}, expected a number from {least:g} to {most:g}')
    return float(value)


def threads_of(threads: int | None, name: str = 'threads') -> int:
    """That many threads, or as many as this process may use."""
    return len(os.sched_getaffinity(0)) if threads is None else whole(name, threads, 1)


def one_recording(given: RecordingLike, role: str) -> _core.Recording:
    """A recording, or that of a file."""
    found = recordings_of(given, role)
    if len(found) != 1:
        raise _core.Error(f'{len(found)} recordings are given, expected one')
    return found[0]


def precision_of(precision: str) -> bool:
    """Whether numbers are single ones."""
    if precision not in ('double', 'float'):
        raise _core.Error(f"precision is {precision!r}, expected 'double' or 'float'")
    return precision == 'float'


__all__: Sequence[str] = ['load_dataset']
