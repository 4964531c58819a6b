# SPDX-License-Identifier: Apache-2.0
import importlib.util
import pathlib

import numpy as np
import physpring
import pytest

torch = pytest.importorskip('torch')
import physpring.torch


def test_gradcheck(twin, other_recording):
    simulator = physpring.Simulator(twin)
    path = torch.tensor(other_recording.controllers[:4], requires_grad=True)
    start = {'position': torch.tensor(other_recording.start[:10], requires_grad=True),
             'velocity': torch.tensor(other_recording.velocity, requires_grad=True)}
    names = ('rest_length', 'dashpot', 'mass', 'drag', 'gravity')
    values = [torch.tensor(np.asarray(simulator.parameters()[name]), dtype=torch.float64,
                           requires_grad=True) for name in names]

    def move(controllers, position, velocity, *given):
        return physpring.torch.rollout(simulator, controllers, position=position, velocity=velocity,
                                       **dict(zip(names, given)))

    assert torch.autograd.gradcheck(move, (path, *start.values(), *values), eps=1e-7, atol=1e-4,
                                    rtol=1e-5)
    # stiffnesses have another scale
    stiffness = torch.tensor(simulator.parameters()['stiffness'], requires_grad=True)
    assert torch.autograd.gradcheck(
        lambda given: physpring.torch.rollout(simulator, path.detach(), stiffness=given),
        (stiffness,), eps=1e-3, atol=1e-8, rtol=1e-5)


def test_leaves_the_simulator_alone(twin, other_recording):
    simulator = physpring.Simulator(twin)
    path = torch.tensor(other_recording.controllers, dtype=torch.float32)
    before, _ = physpring.torch.rollout(simulator, path)
    changed, _ = physpring.torch.rollout(simulator, path, drag=torch.tensor(5.0))
    assert before.dtype == torch.float32
    assert not torch.equal(before, changed)
    assert torch.equal(physpring.torch.rollout(simulator, path)[0], before)
    with pytest.raises(physpring.Error, match="'stiff' is no parameter"):
        physpring.torch.rollout(simulator, path, stiff=torch.ones(3))


def test_inverse_problem_is_solved():
    path = pathlib.Path(__file__).parents[2] / 'python' / 'examples' / 'inverse_problem.py'
    spec = importlib.util.spec_from_file_location('inverse_problem', path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    before, after, _ = example.solve(seed=5, report=lambda line: None)
    assert before[0] > 0.3 and before[1] > 0.1
    assert after[0] < 0.02  # of the stiffness
    assert after[1] < 0.002  # m/s
