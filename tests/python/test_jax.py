# SPDX-License-Identifier: Apache-2.0
import numpy as np
import physpring
import pytest

jax = pytest.importorskip('jax')
import physpring.jax


@pytest.fixture(autouse=True)
def fixture_double():
    jax.config.update('jax_enable_x64', True)


def test_gradient_matches_the_adjoint(twin, other_recording):
    simulator = physpring.Simulator(twin)
    path = other_recording.controllers[:8]
    rollout = physpring.jax.rollout(simulator)
    weights = np.random.default_rng(1).normal(size=(8, 10, 3))
    stiffness = simulator.parameters()['stiffness']

    def loss(controllers, values):
        position, velocity = rollout(controllers, **values)
        return (weights * position).sum() + 0.01 * (weights * velocity).sum()

    values = {'stiffness': stiffness, 'drag': 0.4}
    by_path, by_values = jax.jit(jax.grad(loss, argnums=(0, 1)))(path, values)
    exact = simulator.with_parameters(**values).vjp(path, weights, 0.01 * weights)
    assert np.allclose(by_path, exact['controllers'], rtol=1e-12)
    assert np.allclose(by_values['stiffness'], exact['stiffness'], rtol=1e-12)
    assert np.allclose(by_values['drag'], exact['drag'], rtol=1e-12)
    assert np.array_equal(rollout(path)[0], simulator.rollout(path)[0])


def test_is_mapped(twin, other_recording):
    simulator = physpring.Simulator(twin)
    path = other_recording.controllers[:5]
    rollout = physpring.jax.rollout(simulator)
    drags = np.array([0.1, 0.5, 2.0])
    many = jax.vmap(lambda drag: rollout(path, drag=drag)[0])(drags)
    for drag, one in zip(drags, many):
        assert np.array_equal(one, simulator.with_parameters(drag=drag).rollout(path)[0])
    with pytest.raises(physpring.Error, match="'stiff' is no parameter"):
        rollout(path, stiff=1.0)
