# SPDX-License-Identifier: Apache-2.0
import copy
import importlib.metadata
import importlib.util
import pathlib
import pickle
import subprocess
import sys

import numpy as np
import physpring
import pytest
from conftest import run_program


def test_is_imported_fast():
    # processor time, so that a busy machine does not matter
    program = ('import numpy, time; start = time.process_time(); import physpring; '
               'print(time.process_time() - start)')
    seconds = min(float(subprocess.run([sys.executable, '-c', program], check=True,
                                       capture_output=True, text=True).stdout) for _ in range(3))
    assert seconds < 0.5


def test_has_types_and_one_version():
    folder = pathlib.Path(physpring.__file__).parent
    assert (folder / 'py.typed').exists()
    assert 'class Recording' in (folder / '_core.pyi').read_text()
    assert physpring.__version__ == importlib.metadata.version('physpring')
    assert run_program('--version').stdout == f'physpring {physpring.__version__}\n'
    for name in physpring.__all__:
        assert getattr(physpring, name).__doc__ or name == '__version__', name


def test_program_runs():
    has_mujoco = importlib.util.find_spec('mujoco') is not None
    doctor = run_program('doctor', check=False)
    assert doctor.returncode == (0 if has_mujoco else 1)
    assert 'kernel' in doctor.stdout
    assert run_program('train', check=False).returncode == 2


def test_mujoco_knows_the_plugins():
    mujoco = pytest.importorskip('mujoco')
    program = ("import mujoco; mujoco.MjModel.from_xml_string('<mujoco><extension>"
               "<plugin plugin=\"physpring.springs\"/></extension></mujoco>')")
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert mujoco.__version__.startswith('4.0.')
    assert f'{mujoco.__version__} (headers' in run_program('doctor').stdout


def test_asks_for_mujoco_where_it_is_missing(tmp_path):
    if importlib.util.find_spec('mujoco') is not None:
        pytest.skip('MuJoCo is installed')
    done = run_program('record', 'scene.xml', '-o', tmp_path / 'a.npz', check=False)
    assert done.returncode == 1
    assert "pip install 'physpring[mujoco]'" in done.stderr


def test_things_are_pickled_and_copied(twin, recording):
    for duplicate in (lambda thing: pickle.loads(pickle.dumps(thing)), copy.copy, copy.deepcopy):
        other = duplicate(recording)
        assert (other.hash, other.name, other.path) == (recording.hash, recording.name, recording.path)
        assert np.array_equal(other.points, recording.points)
        again = duplicate(twin)
        assert np.array_equal(again.levels[1].stiffness, twin.levels[1].stiffness)
        again.levels[0].mass[:] = 1
        assert twin.levels[0].mass[0] != 1
    broken = twin.copy()
    broken.levels[0].mass[:] = -1
    with pytest.raises(physpring.Error, match='mass'):
        pickle.dumps(broken)
