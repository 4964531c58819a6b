#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Planning by the adjoint against sampling (the cross-entropy method), at equal time.

    compare_planners.py ROPE.twin.npz CLOTH.twin.npz [--seconds S ...] [--goals N] [--json FILE]

Two tasks: the far end of a rope goes to a place behind an obstacle; a cloth that two hands hold by
corners gets the shape that another path has given it. Twins of models/demo (README.md, quickstart).
Both planners have the same paths, limits, costs, starts and seconds; CEM has the costs alone, so
its rollouts are cheaper. Prints the mean cost of the target, in mm of distance, for each time.
"""
import argparse
import json
import time

import numpy as np
import physpring
from physpring._plan_search import Search
from physpring.planning import Planner


def cem(planner, position, hands, seconds, seed, guess, population=24, elite=6, keep=0.3):
    """The best plan of the cross-entropy method over the numbers of the planner's paths. `guess`:
    it begins about the same path as the planner does; else about hands that stay."""
    random = np.random.default_rng(seed)
    search = Search(planner, hands, {'position': position, 'velocity': None}, np.inf, 10**9)
    size = planner._basis.shape[1] * len(planner._grasps) * 3
    end = time.perf_counter() + seconds
    mean, spread = np.zeros(size), np.full(size, 0.7)
    if guess:
        mean, spread = search.best_of(planner._guesses(hands, position)).ravel(), 0.4 * np.ones(size)
    while time.perf_counter() < end:
        tried, costs = [], []
        for _ in range(population):
            numbers = mean + spread * random.normal(size=size)
            tried.append(numbers)
            costs.append(search.value(numbers))
            if time.perf_counter() >= end:
                break
        best = np.array(tried)[np.argsort(costs)[:elite]]
        mean = keep * mean + (1 - keep) * best.mean(axis=0)
        spread = keep * spread + (1 - keep) * np.maximum(best.std(axis=0), 0.02)
    return search.plan()


def settle(simulator, frames=60):
    hands = simulator._core.rest_controllers
    position, _ = simulator.rollout(np.repeat(hands[None], frames, axis=0))
    return position[-1], hands


def rope_planners(twin, goals, random):
    """The rope hangs 0.5 m above the floor; its far end goes behind a ball."""
    level = 2
    simulator = physpring.Simulator(twin, level)
    hands = simulator._core.rest_controllers + [0, 0, 0.6]
    up = np.linspace(0, 1, 60)[:, None, None]
    path = simulator._core.rest_controllers * (1 - up) + hands * up
    position = simulator.rollout(np.concatenate([path, np.repeat(hands[None], 90, axis=0)]))[0][-1]
    end = int(np.argmin(position[:, 2]))
    for _ in range(goals):
        angle = random.uniform(0, 2 * np.pi)
        way = np.array([np.cos(angle), np.sin(angle), 0])
        goal = position[end] + 0.22 * way + [0, 0, random.uniform(0, 0.05)]
        ball = [*(position[end] + 0.11 * way + 0.01 * random.normal(size=3)), 0.05]
        planner = Planner(twin, level, target_points=[goal], target_nodes=[end], horizon=45, knots=8,
                          grasps=[range(len(hands))], max_speed=0.6, obstacles=[ball])
        yield planner, position, hands


def cloth_planners(twin, goals, random):
    """The cloth lies on the floor, held at two corners; the target is its shape after a fold."""
    level = 3
    simulator = physpring.Simulator(twin, level)
    position, hands = settle(simulator)
    left = hands[:, 1] < hands[:, 1].mean()
    grasps = [np.flatnonzero(left), np.flatnonzero(~left)]
    for _ in range(goals):
        t = np.linspace(0, 1, 61)
        moved = np.repeat(hands[None], 61, axis=0)
        for grasp in grasps:
            way = np.array([0.3, 0, 0]) + 0.03 * random.normal(size=3) * [1, 1, 0]
            lift = random.uniform(0.1, 0.16)
            moved[:, grasp] += (way * (t - np.sin(2 * np.pi * t) / (2 * np.pi))[:, None] +
                                [0, 0, lift] * np.sin(np.pi * t)[:, None]**2)[:, None]
        target = simulator.rollout(moved, position=position)[0][-1]
        planner = Planner(twin, level, target_points=target, horizon=60, knots=8, grasps=grasps,
                          max_speed=0.6)
        yield planner, position, hands


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n', maxsplit=1)[0])
    parser.add_argument('rope')
    parser.add_argument('cloth')
    parser.add_argument('--seconds', type=float, nargs='+', default=[5, 20])
    parser.add_argument('--goals', type=int, default=10)
    parser.add_argument('--json')
    arguments = parser.parse_args()
    results = []
    for name, make, file in (('rope', rope_planners, arguments.rope),
                             ('cloth', cloth_planners, arguments.cloth)):
        twin = physpring.Twin.load(file)
        planners = list(make(twin, arguments.goals, np.random.default_rng(1)))
        for seconds in arguments.seconds:
            row = {'task': name, 'seconds': seconds, 'adjoint': [], 'cem': [], 'cem, guess': [], 'still': []}
            for goal, (planner, position, hands) in enumerate(planners):
                found = planner.plan(position, hands, seconds=seconds, evaluations=10**6)
                sampled = cem(planner, position, hands, seconds, goal, False)
                from_guess = cem(planner, position, hands, seconds, goal, True)
                stay = np.repeat(hands[None], planner.horizon + 1, axis=0)
                still = planner.plan(position, hands, begin_with=stay, seconds=0)
                for key, one in (('adjoint', found), ('cem', sampled), ('cem, guess', from_guess),
                                 ('still', still)):
                    row[key].append({'target': one.target_cost, 'cost': one.cost,
                                     'evaluations': one.evaluations, 'seconds': one.seconds})
            results.append(row)
            print(f'{name}, {seconds:g} s, {len(planners)} goals: ' + '; '.join(
                f'{key} {1e3 * np.mean([one["target"]**0.5 for one in row[key]]):.1f} mm, cost '
                f'{np.mean([one["cost"] for one in row[key]]):.4f}, '
                f'{np.mean([one["evaluations"] for one in row[key]]):.0f} rollouts, '
                f'{np.mean([one["seconds"] for one in row[key]]):.1f} s'
                for key in row if key not in ('task', 'seconds')), flush=True)
            wins = [sum(a['cost'] < b['cost'] for a, b in zip(row['adjoint'], row[other]))
                    for other in ('cem', 'cem, guess')]
            print(f'  the adjoint has the lower cost for {wins} of {len(planners)} goals', flush=True)
    if arguments.json:
        with open(arguments.json, 'w', encoding='utf-8') as file:
            json.dump(results, file, indent=1)


if __name__ == '__main__':
    main()
