# SPDX-License-Identifier: Apache-2.0
import warnings

import numpy as np
import physpring
import pytest
from conftest import run_program

mujoco = pytest.importorskip('mujoco')


@pytest.mark.parametrize('springs', ['tendon', 'plugin', 'flex'])
def test_is_the_programs(twin, tmp_path, springs):
    twin.copy().save(tmp_path / 'chain.twin.npz')
    files = physpring.export(str(tmp_path / 'chain.twin.npz'), tmp_path / 'ours' / 'model', springs=springs)
    run_program('export', tmp_path / 'chain.twin.npz', '-o', tmp_path / 'model', '--springs', springs)
    written = {path.relative_to(tmp_path / 'model').as_posix(): path.read_bytes()
               for path in (tmp_path / 'model').rglob('*') if path.is_file()}
    assert files == written
    for name, content in files.items():
        assert (tmp_path / 'ours' / 'model' / name).read_bytes() == content
    mujoco.MjModel.from_xml_path(str(tmp_path / 'model' / 'scene.xml'))


@pytest.mark.parametrize('springs', ['tendon', 'plugin'])
def test_is_a_spec(twin, springs):
    spec = physpring.export(twin, level=1, springs=springs)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(20):
        mujoco.mj_step(model, data)
    assert np.isfinite(data.qpos).all()
    assert data.time > 0


def test_samples_are_the_programs(twin, tmp_path):
    twin.copy().save(tmp_path / 'chain.twin.npz')
    with warnings.catch_warnings():
        warnings.simplefilter('ignore', physpring.PhyspringWarning)
        physpring.export(tmp_path / 'chain.twin.npz', tmp_path / 'ours' / 'model', samples=2, seed=5)
    run_program('export', tmp_path / 'chain.twin.npz', '-o', tmp_path / 'model', '--samples', 2, '--seed', 5)
    ours = {path.relative_to(tmp_path / 'ours'): path.read_bytes()
            for path in (tmp_path / 'ours').rglob('*') if path.is_file()}
    assert ours == {path.relative_to(tmp_path): path.read_bytes()
                    for path in (tmp_path / 'model').rglob('*') if path.is_file()}
    mujoco.MjModel.from_xml_path(str(tmp_path / 'model' / 'sample_0001' / 'scene_level1.xml'))
    with pytest.raises(physpring.Error, match='folder'):
        physpring.export(twin, samples=2)


def test_says_what_is_wrong(twin, tmp_path):
    with pytest.raises(physpring.Error, match="springs is 'rubber', expected one of 'auto', 'tendon'"):
        physpring.export(twin, tmp_path / 'm', springs='rubber')
    with pytest.raises(physpring.Error, match='level'):
        physpring.export(twin, tmp_path / 'm', level=9)
    assert list(tmp_path.iterdir()) == []
    physpring.export(twin, tmp_path / 'm')
    with pytest.raises(physpring.Error, match='m'):
        physpring.export(twin, tmp_path / 'm')
    physpring.export(twin, tmp_path / 'm', force=True)
