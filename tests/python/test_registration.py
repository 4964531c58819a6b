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


def cube(path, size):
    """Writes the surface of a cube of that size about the origin, and returns points on two sides of
    it."""
    corners = np.array(list(np.ndindex(2, 2, 2))) * size - size / 2
    faces = ['1 2 4 3', '5 7 8 6', '1 5 6 2', '3 4 8 7', '1 3 7 5', '2 6 8 4']
    path.write_text(''.join('v {} {} {}\n'.format(*corner) for corner in corners) +
                    ''.join(f'f {face}\n' for face in faces))
    a, b = (axis.ravel() for axis in np.meshgrid(*2 * [np.linspace(-size / 2, size / 2, 6)]))
    side = np.full_like(a, size / 2)
    return np.unique(np.concatenate([np.stack([a, b, side], 1), np.stack([side, a, b], 1)]), axis=0)


def test_interior_is_the_programs(tmp_path):
    points = cube(tmp_path / 'cube.obj', 0.1)
    seen = physpring.Recording.from_arrays(points=np.stack(5 * [points]), fps=30, mass=0.1)
    seen.save(tmp_path / 'seen.npz')
    for flags, wishes in (([], {}), (['--spacing', '0.03', '--surface'],
                                     {'spacing': 0.03, 'surface': True})):
        run_program('interior', tmp_path / 'seen.npz', '--mesh', tmp_path / 'cube.obj', *flags, '-o',
                    tmp_path / 'filled.npz', '--force')
        filled = physpring.interior(seen, tmp_path / 'cube.obj', **wishes)
        theirs = physpring.Recording.load(tmp_path / 'filled.npz')
        assert filled.arrays()['interior'].shape[0] > 20
        assert np.array_equal(filled.arrays()['interior'], theirs.arrays()['interior'])
    with pytest.raises(physpring.Error, match='a smaller spacing or a closed mesh is needed'):
        physpring.interior(seen, tmp_path / 'cube.obj', spacing=5)
    with pytest.raises(physpring.Error, match="has an array 'interior'"):
        physpring.interior(filled, tmp_path / 'cube.obj')


def test_split_is_the_programs(recording, tmp_path):
    both = np.concatenate([recording.points, recording.points + [0.3, 0, 0]], axis=1)
    count = recording.points.shape[1]
    hands = np.concatenate([recording.controllers, recording.controllers + [0.3, 0, 0]], axis=1)
    two = physpring.Recording.from_arrays('two', points=both, controllers=hands, fps=30, mass=0.1,
                                          object=np.repeat([0, 1], count))
    two.save(tmp_path / 'two.npz')
    run_program('split', tmp_path / 'two.npz', '-o', tmp_path)
    parts = physpring.split(two)
    assert len(parts) == 2
    for part in parts:
        theirs = physpring.Recording.load(tmp_path / f'{part.name}.npz')
        assert part.hash == theirs.hash
        assert part.points.shape[1] == count
    assert [one.hash for one in physpring.split(recording)] == [recording.hash]
