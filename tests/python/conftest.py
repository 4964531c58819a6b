# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python package share. They run with the package that is installed, on a
chain that ten lines of NumPy simulate.
"""
import os
import subprocess
import sys

import numpy as np
import physpring
import pytest

FPS = 30
NODES = 10
GAP = 0.03  # m, of neighbours


def swing(seed, frames=40, noise=5e-4, wind=0.0):
    """Points (T, NODES, 3) and hand (T, 1, 3) of a chain under a hand that moves, m. `wind`: a force
    on each node along x, N."""
    random = np.random.default_rng(seed)
    phase = random.uniform(0, 6, 2)
    mass, stiffness, dashpot, drag = 0.005, 400.0, 0.05, 0.5
    steps = 120
    h = 1 / FPS / steps

    def hand(t):
        return np.array([0.1 * np.sin(5.6 * t + phase[0]) - 0.1 * np.sin(phase[0]),
                         0.06 * np.sin(3.8 * t + phase[1]) - 0.06 * np.sin(phase[1]), 1.0])

    x = np.array([[0, 0, 1 - GAP * (i + 1)] for i in range(NODES)])
    v = np.zeros_like(x)
    points, hands = [x], [hand(0)]
    for step in range((frames - 1) * steps):
        held = np.vstack([hand((step + 1) * h), x])
        moving = np.vstack([np.zeros(3), v])
        force = np.zeros_like(held)
        for reach in (1, 2):
            d = held[reach:] - held[:-reach]
            length = np.linalg.norm(d, axis=1, keepdims=True)
            along = d / length
            closing = ((moving[reach:] - moving[:-reach]) * along).sum(1, keepdims=True)
            pull = (stiffness * (length - reach * GAP) + dashpot * closing) * along
            force[:-reach] += pull
            force[reach:] -= pull
        force[1:, 0] += wind
        v = (v + h * (force[1:] / mass + [0, 0, -9.81])) * np.exp(-h * drag)
        x = x + h * v
        if (step + 1) % steps == 0:
            points.append(x)
            hands.append(hand((step + 1) * h))
    points = np.array(points)
    return points + random.normal(0, noise, points.shape), np.array(hands)[:, None]


def recording_of(name, seed, **how):
    points, controllers = swing(seed, **how)
    return physpring.Recording.from_arrays(name=name, points=points, controllers=controllers, fps=FPS,
                                           mass=0.05)


@pytest.fixture(scope='session')
def recording():
    return recording_of('chain', 1)


@pytest.fixture(scope='session')
def other_recording():
    return recording_of('chain_b', 2)


# options with which a training takes a second
QUICK = {'neighbours': 6, 'cone': 'elliptic', 'controller_velocity': 'on'}


@pytest.fixture(scope='session')
def twin(recording):
    return physpring.train(recording, levels=2, network_epochs=3, **QUICK)


def run_program(*words, check=True):
    """The command `physpring` of this Python."""
    command = os.path.join(os.path.dirname(sys.executable), 'physpring')
    return subprocess.run([command, *map(str, words)], check=check, capture_output=True, text=True)


def expect_same_arrays(path, other_path):
    """Two .npz have the same arrays, bit for bit."""
    with np.load(path) as one, np.load(other_path) as other:
        assert sorted(one.files) == sorted(other.files)
        for name in one.files:
            assert one[name].dtype == other[name].dtype, name
            assert one[name].tobytes() == other[name].tobytes(), name
