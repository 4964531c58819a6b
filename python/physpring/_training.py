# SPDX-License-Identifier: Apache-2.0
"""Recordings -> a twin."""
from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable
from typing import Any

from physpring import _core
from physpring._recordings import RecordingLike, number, recordings_of, seed_of, threads_of, twin_of


def train(recordings: RecordingLike | Iterable[RecordingLike],
          *,
          levels: int = 1,
          output: str | os.PathLike | None = None,
          callback: Callable[[float, str], Any] | None = None,
          threads: int | None = None,
          seed: int = 0,
          from_twin: _core.Twin | str | os.PathLike | None = None,
          effects_of: _core.Twin | str | os.PathLike | None = None,
          resume: bool = False,
          force: bool = False,
          checkpoint_interval: float = 60,
          **options: Any) -> _core.Twin:
    """Learns a twin of an object from recordings of it, as `physpring train` does.

    recordings: a Recording, a path, or several. A folder with a dataset.json stands for its `fit`
        recordings.
    levels: how many levels the twin has, the dense level 0 included.
    output: file to write, NAME.twin.npz. It is a checkpoint while the training runs: after Ctrl-C
        the same call with resume=True goes on from it. None: the twin is only returned.
    callback: is called with the share of the work that is done (0 to 1) and what was done last.
    threads: at most; the result does not depend on it. None: all.
    from_twin: take level 0 from this twin of the same recordings, instead of fitting it.
    effects_of: give the twin the effects of this one, with their values.
    force: overwrite `output`. checkpoint_interval: seconds between two checkpoints.
    options: the other flags of `physpring train` (docs/training.md), with "_" for "-":
        method, neighbours, ratios, reduction, epochs, substeps, precision, cone ...

    Raises Error for what the program would refuse, in its words. How good the twin is on its
    recordings: `evaluate`. A twin that explains little is a PhyspringWarning.
    """
    if output is not None and not os.fspath(output):
        raise _core.Error('output is empty, expected the name of a file')
    if resume and output is None:
        raise _core.Error('resume needs output, the file to go on from')
    number('checkpoint_interval', checkpoint_interval, 0, 1e9)
    wishes = {'levels': levels, **{key: value for key, value in options.items() if value is not None}}
    try:
        return _core.train(
            recordings_of(recordings, 'fit'),
            options_json=_json(wishes),
            seed=seed_of(seed),
            threads=threads_of(threads),
            from_twin=None if from_twin is None else twin_of(from_twin),
            effects_of=None if effects_of is None else twin_of(effects_of),
            output='' if output is None else os.fspath(output),
            resume=resume,
            force=force,
            checkpoint_interval=checkpoint_interval,
            callback=callback)
    except _core.Error as error:
        raise _core.Error(in_words_of_python(str(error))) from None


def in_words_of_python(line: str) -> str:
    """A line of the program with arguments for flags."""
    names = {'from': 'from_twin', 'effects': 'effects_of'}
    return re.sub(r'--([a-z][a-z-]*)',
                  lambda flag: names.get(flag[1], flag[1].replace('-', '_')), line)


def _json(options: dict[str, Any]) -> str:
    """Options as JSON; arrays and numbers of NumPy are lists and numbers."""
    try:
        return json.dumps(options, default=lambda value: value.tolist(), allow_nan=False)
    except (AttributeError, TypeError, ValueError) as error:
        raise _core.Error(f'an option of the training is not a word, number or list: {error}') from None
