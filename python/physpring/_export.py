# SPDX-License-Identifier: Apache-2.0
"""A twin -> MuJoCo models."""
from __future__ import annotations

import os
import shlex
from typing import TYPE_CHECKING

from physpring import _core
from physpring._recordings import number, seed_of, twin_of, whole
from physpring._training import in_words_of_python

if TYPE_CHECKING:
    import mujoco


def export(twin: _core.Twin | str | os.PathLike,
           folder: str | os.PathLike | None = None,
           *,
           level: int | None = None,
           springs: str = 'auto',
           controllers: str = 'auto',
           contact: str = 'auto',
           flexes: int = 8,
           timestep: float | None = None,
           mesh: str | os.PathLike | None = None,
           name: str | None = None,
           samples: int = 0,
           seed: int = 0,
           force: bool = False) -> dict[str, bytes] | mujoco.MjSpec:
    """The levels of a twin as MuJoCo models, as `physpring export` makes them (docs/export.md).

    folder: where to write levelN.xml, scenes and what they need; then the files by name are
        returned. None: nothing is written, and the scene of one level (`level`, default 0) is
        returned as a mujoco.MjSpec, to be changed, attached or compiled.
    springs: 'auto', 'tendon', 'plugin' or 'flex'. controllers: 'auto', 'mocap', 'slide' or 'none'.
    contact: 'auto', 'mujoco', 'plugin' or 'none'. timestep: of the scenes, s. mesh: file of a
    surface to draw. name: prefix of all names. samples: so many twins beside it, as Twin.sample
    draws them from `seed`, each in a folder sample_NNNN (only with `folder`). force: write into a folder that has files in it.
    """
    given = twin_of(twin)
    if folder is None and level is None:
        level = 0
    words = ['physpring', 'export', os.path.basename(given.path)]
    for flag, value, usual in (('-o', _base(folder), None), ('--level', level, None),
                               ('--springs', springs, 'auto'),
                               ('--controllers', controllers, 'auto'),
                               ('--contact', contact, 'auto'), ('--flexes', flexes, 8),
                               ('--timestep', timestep, None), ('--mesh', _base(mesh), None),
                               ('--name', name, None), ('--samples', samples, 0), ('--seed', seed, 0)):
        if value != usual:
            words += [flag, str(value)]
    whole('samples', samples, 0, 1000)
    if samples and folder is None:
        raise _core.Error('samples need a folder; Twin.sample gives them as twins')
    whole('flexes', flexes, 1, 1000)
    if level is not None:
        whole('level', level, 0, 1000)
    if timestep is not None:
        number('timestep', timestep, 1e-9, 1)
    if folder is not None and not os.fspath(folder):
        raise _core.Error('folder is empty, expected the name of one')
    made = _core.export_twin(given, shlex.join(words), name or '', -1 if level is None else level,
                             springs, controllers, contact, flexes, timestep or 0.0,
                             '' if mesh is None else os.fspath(mesh), samples, seed_of(seed))
    if folder is not None:
        try:
            made.write(os.fspath(folder), force)
        except _core.Error as error:
            raise _core.Error(in_words_of_python(str(error))) from None
        return made.files
    return _spec_of(made.files)


def _base(path: str | os.PathLike | None) -> str | None:
    """What a README says of a path: its last part."""
    return None if path is None else os.path.basename(os.path.normpath(os.fspath(path)))


def _spec_of(files: dict[str, bytes]) -> mujoco.MjSpec:
    """The scene of an export of one level."""
    import mujoco  # pylint: disable=import-outside-toplevel
    scene, = (name for name in files if name.startswith('scene'))
    return mujoco.MjSpec.from_string(files[scene].decode(), include=files, assets=files)
