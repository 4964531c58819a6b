# SPDX-License-Identifier: Apache-2.0
"""What makes recordings ready to be trained on: clouds of points without names, recordings of several
objects, and objects of which only the surface is seen."""
from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, Union

from physpring import _core
from physpring._recordings import RecordingLike, number, one_recording, threads_of, whole
from physpring._training import in_words_of_python

#: What tells where the particles of an object are: a recording or a twin of it, or a path of one.
KnownPoints = Union[_core.Recording, _core.Twin, str, os.PathLike]


def register(clouds: RecordingLike,
             *,
             points: int | None = None,
             like: KnownPoints | None = None,
             shape: str | os.PathLike | None = None,
             refine: bool = False,
             markers: bool = False,
             rod: bool = False,
             callback: Callable[[float, str], Any] | None = None,
             threads: int | None = None) -> _core.Recording:
    """Makes points that are followed of clouds whose points have no names, as `physpring register`
    does: depth cameras give clouds, motion capture gives markers.

    clouds: a recording with `surface` (T, S, 3), m, and without `points`.
    points: how many to make. None: half as many again as a cloud has, 400 at most.
    like: take the points of this recording, or twin, of the same object.
    shape: file of the whole object's surface as it is in frame 0, of which the clouds may show one
        side only.
    refine: fit twins to the points, and name them anew where those predict them; some minutes.
    markers: the points are markers, the same ones in each frame in any order. rod: they are along a
        rod; number them along it.
    callback: of `refine`, as of `train`. threads: as of `train`.

    Returns the clouds' recording with `points`. Where they are lost, or may be wrong, is a
    PhyspringWarning. Raises Error for what the program would refuse.
    """
    if shape is not None and like is not None:
        raise _core.Error('shape and like both say where the points are; expected one of them')
    if points is not None and like is not None:
        raise _core.Error("points are like's; expected one of them")
    if rod and not markers:
        raise _core.Error('rod is of markers; expected markers=True')
    if markers and (refine or any(one is not None for one in (points, like, shape))):
        raise _core.Error('markers are points already; expected no points, like, shape or refine')
    given = one_recording(clouds, 'fit')
    if markers:
        return _core.register_markers(given, rod)
    known = None if like is None else _known(like)
    return _core.register_clouds(
        given,
        points=0 if points is None else whole('points', points, 1),
        shape='' if shape is None else os.fspath(shape),
        refine=refine,
        threads=threads_of(threads),
        like=known if isinstance(known, _core.Recording) else None,
        like_twin=known if isinstance(known, _core.Twin) else None,
        callback=callback)


def split(recording: RecordingLike) -> list[_core.Recording]:
    """A recording of each of the objects that a recording shows (its array `object`), as
    `physpring split` makes them; the recording itself where that is one."""
    return _core.split(one_recording(recording, 'fit'))


def interior(recording: RecordingLike,
             mesh: str | os.PathLike,
             *,
             spacing: float = 0.01,
             surface: bool = False) -> _core.Recording:
    """The recording with particles inside its object, which no camera sees, as `physpring interior`
    makes them.

    mesh: file of the object's surface (OBJ, PLY, STL, GLB), on which the recording's points are in
        frame 0; glTF is turned from y up to z up.
    spacing: of the particles inside, m. surface: also on the surface where no point is.

    Where the mesh and the points do not fit is a PhyspringWarning. Raises Error for what the program
    would refuse.
    """
    given = one_recording(recording, 'fit')
    try:
        return _core.interior(given, os.fspath(mesh), number('spacing', spacing, 1e-6, 10), surface)
    except _core.Error as error:
        raise _core.Error(in_words_of_python(str(error))) from None


def _known(given: KnownPoints) -> _core.Recording | _core.Twin:
    if isinstance(given, (str, os.PathLike)) and os.fspath(given).endswith('.twin.npz'):
        return _core.Twin.load(given)
    return given if isinstance(given, _core.Twin) else one_recording(given, 'fit')
