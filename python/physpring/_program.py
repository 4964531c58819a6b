# SPDX-License-Identifier: Apache-2.0
"""The command `physpring`: the program of this package, with the MuJoCo of this Python."""
from __future__ import annotations

import importlib.util
import os
import pathlib
import sys

PROGRAM = pathlib.Path(__file__).parent / 'bin' / 'physpring'


def mujoco_library() -> pathlib.Path | None:
    """libmujoco of the package `mujoco`, which is not imported; None: there is none."""
    spec = importlib.util.find_spec('mujoco')
    if spec is None or not spec.submodule_search_locations:
        return None
    found = sorted(pathlib.Path(spec.submodule_search_locations[0]).glob('libmujoco.so*'))
    return found[0] if found else None


def environment() -> dict[str, str]:
    """What the program runs in."""
    variables = dict(os.environ)
    variables.pop('LD_BIND_NOW', None)  # it may have no MuJoCo
    library = mujoco_library()
    if library is not None:
        variables.setdefault('PHYSPRING_MUJOCO', str(library))
    return variables


def main() -> None:
    """Becomes the program."""
    os.execve(PROGRAM, ['physpring', *sys.argv[1:]], environment())
