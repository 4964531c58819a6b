# SPDX-License-Identifier: Apache-2.0
"""The engine's part that needs MuJoCo: `scenes()`; and where tasks are."""
from __future__ import annotations

import ctypes
import functools
import importlib
import os
import pathlib
from typing import Any

from physpring import _core
from physpring._program import mujoco_library

PLUGIN = pathlib.Path(__file__).parent / 'plugin' / 'libphyspring_plugin.so'
TASKS = pathlib.Path(__file__).parent / 'tasks'
ADAPTERS = pathlib.Path(__file__).parent / 'adapters'
OBJECTS = pathlib.Path(__file__).parent / 'objects'


@functools.cache
def scenes() -> Any:
    """The module physpring._scenes, on the MuJoCo of this Python. Raises Error where there is none,
    or one of another version than 4.0.x."""
    library = mujoco_library()
    if library is None:
        raise _core.Error("MuJoCo is not installed, which this needs: pip install 'physpring[mujoco]'")
    # MuJoCo's own module first, because it says what MuJoCo does with errors and warnings
    import mujoco  # noqa: F401 pylint: disable=import-outside-toplevel,unused-import
    # its functions for all of the process: _scenes is linked with no MuJoCo of one version
    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL | os.RTLD_NOLOAD)
    module = importlib.import_module('physpring._scenes')
    module.expect_mujoco()
    module.load_plugin(str(PLUGIN))
    return module


def task_folder(task: str | os.PathLike) -> pathlib.Path:
    """The folder of a task: one of this package ('rope_routing'), or your own."""
    own = pathlib.Path(task)
    folder = own if (own / 'task.json').exists() else TASKS / own
    if not (folder / 'task.json').exists():
        known = ', '.join(sorted(one.parent.name for one in TASKS.glob('*/task.json')))
        raise _core.Error(f'{task}: is no folder with a task.json, nor one of {known}')
    return folder


def adapter_file(adapter: str | os.PathLike) -> str:
    """The path of a policy adapter: one of this package ('lerobot_state'), or your own file; '' for
    none."""
    if not os.fspath(adapter):
        return ''
    own = pathlib.Path(adapter)
    path = own if own.exists() else ADAPTERS / f'{own}.json'
    if not path.exists():
        known = ', '.join(sorted(one.stem for one in ADAPTERS.glob('*.json')))
        raise _core.Error(f'{adapter}: is no file, nor one of {known}')
    return str(path.resolve())
