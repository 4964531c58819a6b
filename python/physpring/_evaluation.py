# SPDX-License-Identifier: Apache-2.0
"""A twin against recordings: what it predicts, how far that is off, and where hidden parts are."""
from __future__ import annotations

import dataclasses
import html
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physpring import _core
from physpring._recordings import (
    RecordingLike,
    number,
    one_recording,
    precision_of,
    recordings_of,
    seed_of,
    threads_of,
    twin_of,
    whole,
)
from physpring._training import in_words_of_python

Array = NDArray[np.float64]


class Evaluation:
    """How far a twin is from recordings. `print` shows the tables of `physpring eval`."""

    def __init__(self, result: _core.EvaluationResult, recordings: Sequence[_core.Recording]):
        self._result = result
        self._recordings = recordings

    def to_dict(self) -> dict[str, Any]:
        """What `physpring eval --json` writes (docs/eval.md); lengths in metres."""
        return json.loads(self._result.json())

    def points(self, recording: int = 0, level: int = 0) -> Array:
        """(T, N, 3) the measured points as the level predicts them, in all frames, m."""
        return self._result.points(whole('recording', recording, 0), whole('level', level, 0))

    def errors(self, recording: int = 0, level: int = 0) -> Array:
        """(T,) mean distance of predicted from measured points in each frame, m; NaN: none seen."""
        return self._result.errors(whole('recording', recording, 0), whole('level', level, 0))

    def save_json(self, path: str | os.PathLike) -> None:
        """Writes what `physpring eval --json` does."""
        with open(path, 'w', encoding='utf-8') as file:
            file.write(self._result.json())

    def save_page(self, path: str | os.PathLike) -> None:
        """Writes a page with pictures and a film, as `physpring eval --picture` does."""
        with open(path, 'w', encoding='utf-8') as file:
            file.write(self._result.html())

    def save_rerun(self, path: str | os.PathLike) -> None:
        """Writes a file NAME.rrd for the Rerun viewer: measured points, what each level predicts of
        them, controllers, and errors [m], frame by frame. Needs the extra `rerun`."""
        import rerun  # pylint: disable=import-outside-toplevel
        stream = rerun.RecordingStream('physpring')
        stream.save(os.fspath(path))
        levels = range(len(self.to_dict()['levels']))
        for number, recording in enumerate(self._recordings):
            name = f'{number}_{recording.name}'
            predicted = [self.points(number, level) for level in levels]
            errors = [self.errors(number, level) for level in levels]
            for frame, measured in enumerate(recording.points):
                stream.set_time('frame', sequence=frame)
                stream.set_time('time', duration=frame / recording.fps)
                stream.log(f'{name}/measured', rerun.Points3D(_seen(measured), colors=_MEASURED))
                stream.log(f'{name}/controllers', rerun.Points3D(recording.controllers[frame]))
                for level in levels:
                    stream.log(f'{name}/level_{level}', rerun.Points3D(predicted[level][frame]))
                    if np.isfinite(errors[level][frame]):
                        stream.log(f'{name}/error/level_{level}', rerun.Scalars(errors[level][frame]))
        stream.flush()

    def __str__(self) -> str:
        return self._result.text()

    def __repr__(self) -> str:
        levels = self.to_dict()['levels']
        errors = ', '.join(f"level {level['level']} {_millimetres(level)}" for level in levels)
        return f'<physpring.Evaluation: {errors}>'

    def _repr_html_(self) -> str:
        return f'<pre>{html.escape(str(self))}</pre>'


_MEASURED = (40, 40, 40)  # RGB, as on the pages of `eval`


def _seen(points: Array) -> Array:
    return points[np.isfinite(points).all(axis=1)]


def _millimetres(level: dict[str, Any]) -> str:
    error = level['prediction']['track_lifted']
    return 'no data' if error is None else f'{1e3 * error:.2f} mm'


_MOST = 10**6  # as the program's options


def _expect_counts(**counts: int | None) -> None:
    for name, count in counts.items():
        if count is not None:
            whole(name, count, 1, _MOST)


def evaluate(twin: _core.Twin | str | os.PathLike,
             recordings: RecordingLike | Iterable[RecordingLike],
             *,
             substeps: int | None = None,
             precision: str = 'double',
             anchor: int | None = None,
             predictions: Mapping[str, ArrayLike] | None = None,
             images: str | os.PathLike | None = None,
             splats: str | os.PathLike | None = None,
             cameras: str | Sequence[str] = (),
             threads: int | None = 1) -> Evaluation:
    """Predicts recordings of the twin's object with every level of it, as `physpring eval` does.

    recordings: a Recording, a path, or several; a folder stands for its `heldout` ones. anchor: also
    predict anew from this frame on, from the state that `track` finds there. threads: recordings, or
    pictures, at the same time. A twin that is no better than what needs no twin is a
    PhyspringWarning.

    Of one recording, also: predictions: {name: (T, N + M, 3) particles, m} of other methods, judged
    in the same way. images: folder of its pictures (`record --pictures`); they are compared with
    what `cameras` of it, or all, see of the file `splats`, which `physpring fit-splats` makes.
    """
    _expect_counts(substeps=substeps, anchor=anchor)
    if (images is None) != (splats is None):
        raise _core.Error('images and splats go together')
    if isinstance(cameras, str):
        cameras = [cameras]
    if cameras and images is None:
        raise _core.Error('cameras are of images, which are missing')
    one, given = twin_of(twin), recordings_of(recordings, 'heldout')
    others = {name: np.ascontiguousarray(array, float) for name, array in (predictions or {}).items()}
    return Evaluation(
        _core.evaluate(one, given, substeps, precision_of(precision), anchor, others,
                       os.fspath(images or ''), os.fspath(splats or ''), list(cameras),
                       threads_of(threads)), given)


def predict(twin: _core.Twin | str | os.PathLike,
            recording: RecordingLike,
            *,
            level: int = 0,
            substeps: int | None = None,
            precision: str = 'double') -> Array:
    """(T, nodes, 3) where the nodes of a level are in each frame of a recording, m: from its start
    and the motion of its controllers alone."""
    _expect_counts(substeps=substeps)
    one = one_recording(recording, 'heldout')
    return _core.predict(twin_of(twin), one, whole('level', level, 0), substeps, precision_of(precision))


@dataclasses.dataclass(frozen=True, repr=False)
class Track:
    """Where all particles of an object are, found from a part of them. Errors are mean distances of
    the points that were not told, m; NaN where there are none."""
    position: Array  #: (T, particles, 3) m
    velocity: Array  #: (T, particles, 3) m/s
    hidden: NDArray[np.int32]  #: the points that were not told
    error: float
    error_predicted: float  #: of the prediction from frame 0, without any measurement
    error_interpolated: float  #: of interpolation between the points that are told, without a twin
    cloud_distance: float  #: of clouds from the nearest particles in the last second; NaN without
    frames_per_second: float  #: of processor time, by one thread

    def __repr__(self) -> str:
        frames, particles = self.position.shape[:2]
        return (f'<physpring.Track: {particles} particles in {frames} frames, {len(self.hidden)} points '
                f'hidden, {1e3 * self.error:.2f} mm off>')


def track(twin: _core.Twin | str | os.PathLike,
          recording: RecordingLike,
          *,
          cloud: bool = False,
          hide: float = 0,
          seed: int = 1,
          substeps: int | None = None) -> Track:
    """Follows a twin's object through a recording that sees only a part of it, as `physpring track`
    does. cloud: follow the recording's `surface`, and judge by its points if it has any; without them
    the twin is placed in the first cloud. hide: this part of the
    points is not told (0 to 0.95), and judged by; `seed` says which. substeps: a frame; fewer than
    it takes soften the stiffest nodes, which is faster and less exact.
    """
    _expect_counts(substeps=substeps)
    number('hide', hide, 0, 0.95)
    if cloud and hide > 0:
        raise _core.Error('hide is for points: with cloud=True all of them are hidden')
    one = one_recording(recording, 'heldout')
    try:
        return Track(**_core.track(twin_of(twin), one, cloud, hide, seed_of(seed), substeps))
    except _core.Error as error:
        raise _core.Error(in_words_of_python(str(error))) from None
