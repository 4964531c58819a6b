# SPDX-License-Identifier: Apache-2.0
import warnings

import numpy as np
import physpring
import pytest
from conftest import FPS, NODES, expect_same_arrays, run_program, swing


def test_is_made_of_arrays(recording):
    points, hands = swing(1)
    assert np.array_equal(recording.points, points)
    assert np.array_equal(recording.controllers, hands)
    assert (recording.fps, recording.mass, recording.name, len(recording)) == (FPS, 0.05, 'chain', 40)
    assert recording.points.shape == (40, NODES, 3)
    assert recording.ground is None
    assert np.allclose(recording.gravity, [0, 0, -9.81])
    assert "'chain': 10 points, 1 controllers, 40 frames at 30 fps, 0.05 kg" in repr(recording)


def test_file_is_the_same_recording(recording, tmp_path):
    path = tmp_path / 'saved.npz'
    recording.save(str(path))
    read = physpring.Recording.load(str(path))
    assert read.hash == recording.hash
    assert read.name == 'saved'
    assert np.array_equal(read.points, recording.points)
    assert read.arrays().keys() == recording.arrays().keys()
    assert read.arrays()['fps'].shape == ()


def test_takes_what_becomes_an_array():
    points, hands = swing(1)
    lists = physpring.Recording.from_arrays(points=points.tolist(), controllers=hands.tolist(), fps=30,
                                            mass=0.05)
    turned = physpring.Recording.from_arrays(points=np.asfortranarray(points),
                                             controllers=hands[:, ::1], fps=np.float32(30), mass=0.05)
    assert np.array_equal(lists.points, turned.points)
    single = physpring.Recording.from_arrays(points=points.astype(np.float32), fps=30, mass=0.05)
    assert single.controllers.shape == (40, 0, 3)
    assert np.allclose(single.points, points, atol=1e-7)


def test_says_what_is_wrong():
    points, hands = swing(1)

    def message(**arrays):
        with pytest.raises(physpring.Error) as caught:
            physpring.Recording.from_arrays(**arrays)
        return str(caught.value)

    assert isinstance(physpring.Error('x'), ValueError)
    assert message(points=points[0], fps=30) == (
        "recording.npz: array 'points' has the shape (10, 3), expected (T, N, 3)")
    assert 'controllers' in message(points=points, controllers=hands[:5], fps=30)
    assert message(points=points, controllers=hands).startswith("recording.npz: array 'fps' is missing")
    assert 'speed' in message(points=points, fps=30, speed=1)
    assert message(points=points, fps='fast') == "array 'fps' is not of numbers or truth values"
    broken = points.copy()
    broken[3, 4, 1] = np.inf
    assert 'points' in message(points=broken, fps=30)


def test_warns_of_what_it_assumes():
    points, hands = swing(1)
    with pytest.warns(physpring.PhyspringWarning, match='mass'):
        assumed = physpring.Recording.from_arrays(points=points, controllers=hands, fps=30)
    assert any('mass' in line for line in assumed.check())
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        with pytest.raises(physpring.PhyspringWarning):
            physpring.Recording.from_arrays(points=points, controllers=hands, fps=30)


def test_load_says_which_file(tmp_path):
    with pytest.raises(physpring.Error, match='nothing.npz'):
        physpring.Recording.load(tmp_path / 'nothing.npz')
    broken = tmp_path / 'broken.npz'
    broken.write_bytes(b'PK\x03\x04 nonsense')
    with pytest.raises(physpring.Error, match='broken.npz'):
        physpring.load_dataset(broken)
    with pytest.raises(physpring.Error, match='role'):
        physpring.load_dataset(broken, role='test')


def test_records_what_the_program_does(tmp_path):
    pytest.importorskip('mujoco')
    from physpring._mujoco import OBJECTS
    effects = {'air_drag.drag_kg_per_m': 0.02, 'air_drag.wind_y_m_per_s': 2}
    ours = physpring.record('cord', tmp_path / 'ours.npz', noise=1e-3, seed=3, vary=0.05, fps=50,
                            effects=effects)
    run_program('record', OBJECTS / 'cord.xml', '-o', tmp_path / 'theirs.npz', '--noise', 1e-3, '--seed',
                3, '--vary', 0.05, '--fps', 50, *(word for key, value in effects.items()
                                                 for word in ('--effect', f'{key}={value}')))
    expect_same_arrays(tmp_path / 'ours.npz', tmp_path / 'theirs.npz')
    assert np.array_equal(physpring.record('cord', seed=1).points,
                          physpring.record(OBJECTS / 'cord.xml', seed=1).points)
    assert ours.name == 'ours'
    with pytest.raises(physpring.Error, match='snake'):
        physpring.record('snake')
    with pytest.raises(physpring.Error, match='storm'):
        physpring.record('cord', effects={'storm': 1})
