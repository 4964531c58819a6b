# SPDX-License-Identifier: Apache-2.0
import numpy as np
import physpring
import pytest
from conftest import run_program


def clouds_of(recording):
    """What a camera sees of it: points in another order in each frame."""
    random = np.random.default_rng(5)
    points = recording.points
    surface = np.stack([frame[random.permutation(len(frame))] for frame in points])
    return physpring.Recording.from_arrays('clouds', surface=surface, fps=recording.fps, mass=0.05,
                                           controllers=recording.controllers)


def test_clouds_are_a_recording_without_points(twin, recording, tmp_path):
    clouds = clouds_of(recording)
    assert clouds.points.shape == (len(recording), 0, 3)
    assert 'clouds' in repr(clouds)
    clouds.save(tmp_path / 'clouds.npz')
    assert physpring.Recording.load(tmp_path / 'clouds.npz').hash == clouds.hash
    for use in (physpring.train, lambda one: physpring.evaluate(twin, one),
                lambda one: physpring.diagnose(twin, one)):
        with pytest.raises(physpring.Error, match="no 'points'; `physpring register` makes points"):
            use(clouds)


def test_is_the_programs(recording, tmp_path):
    clouds = clouds_of(recording)
    clouds.save(tmp_path / 'clouds.npz')
    recording.save(tmp_path / 'known.npz')
    run_program('register', tmp_path / 'clouds.npz', '--like', tmp_path / 'known.npz', '-o',
                tmp_path / 'named.npz')
    named = physpring.register(clouds, like=recording)
    theirs = physpring.Recording.load(tmp_path / 'named.npz')
    assert named.hash == theirs.hash
    assert np.array_equal(named.points, theirs.points, equal_nan=True)
    run_program('register', tmp_path / 'clouds.npz', '--points', '9', '-o', tmp_path / 'own.npz')
    own = physpring.register(tmp_path / 'clouds.npz', points=9)
    assert np.array_equal(own.points, physpring.Recording.load(tmp_path / 'own.npz').points,
                          equal_nan=True)


def test_a_twin_says_where_the_points_are(twin, recording):
    clouds = clouds_of(recording)
    named = physpring.register(clouds, like=twin)
    assert named.points.shape == recording.points.shape
    physpring.evaluate(twin, named)
    state = physpring.track(twin, clouds, cloud=True)
    assert state.position.shape[0] == len(recording)
    assert np.isnan(state.error) and len(state.hidden) == 0
    assert state.cloud_distance < 0.01
    with pytest.raises(physpring.Error, match="no 'points'; cloud follows them"):
        physpring.track(twin, clouds)


def test_markers(recording, tmp_path):
    clouds = clouds_of(recording)
    clouds.save(tmp_path / 'markers.npz')
    run_program('register', tmp_path / 'markers.npz', '--markers', '-o', tmp_path / 'chain.npz')
    chain = physpring.register(clouds, markers=True)
    assert chain.hash == physpring.Recording.load(tmp_path / 'chain.npz').hash


@pytest.mark.parametrize('wishes, why', [
    ({'like': 'x.npz', 'shape': 'x.obj'}, 'expected one of them'),
    ({'like': 'x.npz', 'points': 9}, 'expected one of them'),
    ({'rod': True}, 'expected markers=True'),
    ({'markers': True, 'refine': True}, 'markers are points already'),
    ({'points': 0}, 'points is 0'),
    ({'shape': 'no_such.obj'}, 'no_such.obj'),
])
def test_refuses(recording, wishes, why):
    with pytest.raises(physpring.Error, match=why):
        physpring.register(clouds_of(recording), **wishes)


def test_has_points_already(recording):
    with pytest.raises(physpring.Error, match="has 'points' already"):
        physpring.register(recording)
