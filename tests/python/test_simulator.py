# SPDX-License-Identifier: Apache-2.0
import pickle

import numpy as np
import physpring
import pytest
from conftest import NODES


@pytest.fixture(name='case')
def fixture_case(twin, other_recording):
    """A simulator of level 0, a path, and a start."""
    start = {'position': other_recording.start[:NODES], 'velocity': other_recording.velocity}
    return physpring.Simulator(twin), other_recording.controllers, start


def test_moves_as_predicted(twin, other_recording, case):
    simulator, path, start = case
    for precision in ('double', 'float'):
        predicted = physpring.predict(twin, other_recording, precision=precision)
        moved = physpring.simulate(twin, path, precision=precision, **start)
        assert np.array_equal(moved, predicted)
    assert np.array_equal(simulator.rollout(path, **start)[0],
                          physpring.predict(twin, other_recording))
    # a coarse level starts at its members' means
    coarse = physpring.simulate(twin, path, level=1, position=twin.average(1, start['position']),
                                velocity=twin.average(1, start['velocity']))
    assert np.array_equal(coarse, physpring.predict(twin, other_recording, level=1))
    lifted = twin.lift(1, start['position'], coarse)
    evaluation = physpring.evaluate(twin, other_recording)
    assert np.allclose(lifted, evaluation.points(level=1), atol=1e-12)


def test_goes_frame_by_frame(case):
    simulator, path, start = case
    position, velocity = simulator.rollout(path, **start)
    assert np.array_equal(simulator.reset(controllers=path[0], **start), position[0])
    for t in range(1, 12):
        assert np.array_equal(simulator.step(path[t]), position[t])
        assert np.array_equal(simulator.velocity, velocity[t])
    kept = pickle.loads(pickle.dumps(simulator.state))
    ahead = simulator.step(path[12])
    simulator.state = kept
    assert kept.frame == 11
    assert np.array_equal(simulator.step(path[12]), ahead)
    simulator.reset()
    assert np.array_equal(simulator.step(), simulator.position)  # the hand stays


def test_gradient_matches_differences(case):
    simulator, path, start = case
    path = path[:12].copy()
    # training may leave a spring without damping, where no difference can be taken to both sides
    dashpot = np.maximum(simulator.parameters()['dashpot'], 1e-4)
    simulator = simulator.with_parameters(dashpot=dashpot)
    random = np.random.default_rng(0)
    weights = random.normal(size=(2, 12, NODES, 3))

    def loss(of=simulator, controllers=path, **changed):
        position, velocity = of.rollout(controllers, **{**start, **changed})
        return (weights[0] * position).sum() + 0.02 * (weights[1] * velocity).sum()

    gradient = simulator.vjp(path, weights[0], 0.02 * weights[1], **start)
    values = simulator.parameters()
    assert set(gradient) == set(values) | {'position', 'velocity', 'controllers'}

    def expect(name, value, change, move):
        value = np.asarray(value, float)
        direction = random.normal(size=value.shape) * change
        wide, narrow = ((move(value + s * direction) - move(value - s * direction)) / (2 * s)
                        for s in (1, 0.5))
        numeric = (4 * narrow - wide) / 3
        exact = (np.asarray(gradient[name]) * direction).sum()
        assert exact == pytest.approx(numeric, rel=1e-5, abs=1e-9), name

    for name, change in (('stiffness', 1e-3), ('rest_length', 1e-6), ('dashpot', 1e-5), ('mass', 1e-7),
                         ('drag', 1e-4), ('gravity', 1e-4)):
        expect(name, values[name], change,
               lambda value, name=name: loss(simulator.with_parameters(**{name: value})))
    for name in ('position', 'velocity'):
        expect(name, start[name], 1e-6, lambda value, name=name: loss(**{name: value}))
    expect('controllers', path, 1e-6, lambda value: loss(controllers=value))


def test_parameters_are_set_or_not_at_all(case):
    simulator, path, start = case
    before = simulator.rollout(path, **start)[0]
    values = simulator.parameters()
    with pytest.raises(physpring.Error, match=r'^stiffness has shape \(2\), expected'):
        simulator.set(drag=2.0, stiffness=[1.0, 2.0])
    with pytest.raises(physpring.Error, match="parameter 'stiffnes' is unknown; there are stiffness"):
        simulator.set(stiffnes=values['stiffness'])
    with pytest.raises(physpring.Error, match='mass'):
        simulator.set(mass=-values['mass'])
    with pytest.raises(physpring.Error, match='finite'):
        simulator.set(drag=np.nan)
    assert np.array_equal(simulator.rollout(path, **start)[0], before)
    simulator.set(drag=2.0, gravity=[0, 0, -1.6])
    assert simulator.parameters()['drag'] == 2
    assert not np.array_equal(simulator.rollout(path, **start)[0], before)


def test_says_what_is_wrong(twin, case):
    simulator, path, _ = case
    with pytest.raises(physpring.Error, match=r'controllers has shape \(40, 3\), expected 3 dim'):
        simulator.rollout(path[:, 0])
    with pytest.raises(physpring.Error, match=r'position has shape \(3, 3\), expected \(10, 3\)'):
        simulator.rollout(path, position=np.zeros((3, 3)))
    with pytest.raises(physpring.Error, match='substeps is 0'):
        physpring.Simulator(twin, substeps=0)
    with pytest.raises(physpring.Error, match='diverges in frame'):
        physpring.simulate(twin, path, substeps=1)
    with pytest.raises(physpring.Error, match='level'):
        physpring.Simulator(twin, level=7)
    with pytest.raises(physpring.Error, match='precision'):
        physpring.Simulator(twin, precision='half')


def test_ground_holds(twin, case):
    _, path, start = case
    down = np.repeat(path[:1], 60, axis=0)
    down[:, 0, 2] -= np.linspace(0, 0.2, 60)  # the chain's end goes from 0.7 to 0.5 m
    free = physpring.simulate(twin, down, **start)
    assert free[..., 2].min() < 0.52
    held = physpring.simulate(twin, down, ground=[0, 0, 2, 1.2], **start)  # z = 0.6
    assert held[..., 2].min() > 0.59
    far = physpring.simulate(twin, down, ground=[0, 0, 1, 0.1], **start)
    assert np.array_equal(far, free)


def test_levels_are_views(twin):
    changed = twin.copy()
    changed.levels[0].stiffness[:] *= 2
    changed.levels[0].drag = 3.0
    assert np.array_equal(changed.levels[0].stiffness, 2 * twin.levels[0].stiffness)
    level = changed.levels[0]
    del changed  # what is seen keeps the twin alive
    stiffness = level.stiffness
    del level
    assert stiffness.sum() > 0
    level = twin.levels[0]
    assert level.position.shape == (level.node_count + level.controller_count, 3)
    assert level.springs.shape == (level.spring_count, 2)
    assert not level.springs.flags.writeable
    assert twin.levels[1].assignment.shape == (level.node_count,)
    assert 0 < level.largest_timestep() < 0.1
