# SPDX-License-Identifier: Apache-2.0
"""Recordings from files, and what functions take for recordings."""
from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import Union

from physpring import _core

RecordingLike = Union[_core.Recording, str, os.PathLike]


def load_dataset(*paths: str | os.PathLike, role: str = 'fit') -> list[_core.Recording]:
    """The recordings of files, and of folders with a dataset.json (docs/files.md).

    role: of a folder's recordings, 'fit' for those to train on, 'heldout' for those to judge by.
    """
    return _core.load_dataset([os.fspath(path) for path in paths], role)


def recordings_of(given: RecordingLike | Iterable[RecordingLike], role: str) -> list[_core.Recording]:
    """A recording, a path, or several of them, as a list of recordings."""
    if isinstance(given, (_core.Recording, str, os.PathLike)):
        given = [given]
    found: list[_core.Recording] = []
    for one in given:
        if isinstance(one, _core.Recording):
            found.append(one)
        else:
            found += load_dataset(one, role=role)
    return found


def twin_of(given: _core.Twin | str | os.PathLike) -> _core.Twin:
    """A twin, or that of a file."""
    return given if isinstance(given, _core.Twin) else _core.Twin.load(given)


def threads_of(threads: int | None) -> int:
    """That many threads, or as many as this process may use."""
    if threads is None:
        return len(os.sched_getaffinity(0))
    if threads < 1:
        raise _core.Error(f'threads is {threads}, expected 1 or more')
    return threads


def precision_of(precision: str) -> bool:
    """Whether numbers are single ones."""
    if precision not in ('double', 'float'):
        raise _core.Error(f"precision is {precision!r}, expected 'double' or 'float'")
    return precision == 'float'


__all__: Sequence[str] = ['load_dataset']
