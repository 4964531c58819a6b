#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An inverse problem with PyTorch: a field of stiffness along a rope, and the velocities with which
it starts, from its motion.

    python inverse_problem.py

The rope hangs from a hand that moves. It is softer in the middle, and it is in motion when the
recording starts. Only positions are given. What is unknown is a stiffness for each spring and a
velocity for each node, both as smooth fields of few numbers: motions from node to node die within
a frame, so no picture shows them. L-BFGS follows exact gradients through the whole simulation.
Needs the package with its extra `torch`.
"""
import argparse
import time

import numpy as np
import physpring
import physpring.torch
import torch

NODES, GAP, FPS, FRAMES = 20, 0.02, 30, 30
FIELD = 6  # numbers of a field along the rope


def hand():
    """(FRAMES, 1, 3) its path, m."""
    t = np.arange(FRAMES) / FPS
    return np.stack([0.05 * np.sin(4 * t), 0.03 * np.sin(6 * t), np.ones_like(t)], axis=1)[:, None]


def some_twin(seed):
    """A twin of a hanging rope, quickly trained on a motion of a few lines: it gives the net of
    springs and start values."""
    random = np.random.default_rng(seed)
    x = np.array([[0, 0, 1 - GAP * (i + 1)] for i in range(NODES)])
    v = np.zeros_like(x)
    path, points, steps = hand(), [x], 100
    h = 1 / FPS / steps
    for frame in range(1, FRAMES):
        for step in range(steps):
            share = (step + 1) / steps
            held = np.vstack([path[frame - 1] + share * (path[frame] - path[frame - 1]), x])
            force = np.zeros_like(held)
            for reach in (1, 2):
                d = held[reach:] - held[:-reach]
                length = np.linalg.norm(d, axis=1, keepdims=True)
                pull = 300 * (length - reach * GAP) * d / length
                force[:-reach] += pull
                force[reach:] -= pull
            v = (v + h * (force[1:] / 0.003 + [0, 0, -9.81])) * np.exp(-h * 1.0)
            x = x + h * v
        points.append(x)
    points = np.array(points) + random.normal(0, 2e-4, (FRAMES, NODES, 3))
    recording = physpring.Recording.from_arrays(points=points, controllers=path, fps=FPS,
                                                mass=0.003 * NODES)
    return physpring.train(recording, neighbours=4, cone='elliptic', controller_velocity='on')


def curve(place, numbers):
    """A smooth curve along the rope through a few numbers, (FIELD, ...), at `place`, (n,) from 0 to
    1: a stiffness's logarithm, or a velocity."""
    knots = torch.linspace(0, 1, FIELD, dtype=torch.float64)
    weight = torch.exp(-0.5 * ((place[:, None] - knots) * (FIELD - 1) / 0.7) ** 2)
    return (weight / weight.sum(dim=1, keepdim=True)) @ numbers


def solve(seed=0, report=print):
    """How far stiffnesses (relative), velocities across the rope and those along it (m/s) are off,
    before and after; and the seconds it took."""
    twin = some_twin(seed)
    simulator = physpring.Simulator(twin)
    path = torch.tensor(hand())
    base = torch.tensor(simulator.parameters()['stiffness'])
    nodes = torch.linspace(0, 1, NODES, dtype=torch.float64)
    springs = torch.tensor(np.minimum(twin.levels[0].springs, NODES - 1).mean(axis=1) / (NODES - 1))
    random = np.random.default_rng(seed + 1)

    # the truth, and the motion that is given
    true_numbers = torch.tensor([0.1, -0.2, -0.7, -0.7, -0.2, 0.1], dtype=torch.float64)
    true_stiffness = base * curve(springs, true_numbers).exp()
    true_velocity = curve(nodes, torch.tensor(random.normal(0, 0.3, (FIELD, 3))))
    target, _ = physpring.torch.rollout(simulator, path, stiffness=true_stiffness,
                                        velocity=true_velocity)

    numbers = torch.zeros(FIELD, dtype=torch.float64, requires_grad=True)
    motion = torch.zeros(FIELD, 3, dtype=torch.float64, requires_grad=True)
    optimizer = torch.optim.LBFGS([numbers, motion], max_iter=500, history_size=50,
                                  tolerance_grad=1e-12, tolerance_change=1e-14,
                                  line_search_fn='strong_wolfe')

    def loss():
        optimizer.zero_grad()
        position, _ = physpring.torch.rollout(simulator, path, velocity=curve(nodes, motion),
                                              stiffness=base * curve(springs, numbers).exp())
        value = (position - target).square().mean() / GAP**2
        value.backward()
        return value

    def errors():
        stiffness = base * curve(springs, numbers.detach()).exp()
        off = (curve(nodes, motion.detach()) - true_velocity).square().mean(dim=0).sqrt()
        return ((stiffness / true_stiffness - 1).abs().mean().item(), off[:2].norm().item(),
                off[2].item())

    before, start = errors(), time.perf_counter()
    optimizer.step(loss)
    seconds, after = time.perf_counter() - start, errors()
    report(f'{len(base)} springs, {NODES} nodes, {FRAMES} frames, {simulator.substeps} sub-steps each')
    report(f'stiffness off by {before[0]:.2%} before, {after[0]:.4%} after')
    report(f'velocity across the rope off by {before[1]:.4f} m/s before, {after[1]:.6f} m/s after')
    report(f'velocity along it (which dies within a frame) {before[2]:.4f} and {after[2]:.4f} m/s')
    report(f'{optimizer.state_dict()["state"][0]["func_evals"]} gradients in {seconds:.1f} s')
    return before, after, seconds


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('--seed', type=int, default=0)
    solve(parser.parse_args().seed)
