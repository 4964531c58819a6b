# SPDX-License-Identifier: Apache-2.0
"""Paths for hands: where to move what holds an object, so that it does what is wanted.

    from physpring.planning import Planner
    planner = Planner(twin, level=2, target_points=target, horizon=45, max_speed=0.5)
    plan = planner.plan(position, controllers)
    plan.controllers                              # (horizon + 1, controllers, 3), m

The path is found by the exact gradient of the simulation (Simulator.vjp) and L-BFGS. It keeps to a
speed, stretches no spring too far, and stays out of obstacles. In a loop, `replan` begins with what
is left of the plan before (model predictive control). Needs SciPy: pip install 'physpring[plan]'.
"""
from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physpring import _core
from physpring._plan_search import Plan, Search, hat_functions
from physpring._recordings import number, twin_of, whole
from physpring._simulation import Simulator, _doubles

Array = NDArray[np.float64]
Cost = Callable[[Array], tuple[float, Array]]
__all__ = ['Plan', 'Planner', 'plan']


class Planner:
    """Plans for one level of a twin.

    target_points: (N, 3) where nodes should be in the last frame, m; NaN: anywhere. `target_nodes`
        says which nodes they are of, default: the first ones.
    target_cost: instead, a function of positions (T, nodes, 3) that gives a cost and its
        derivatives (T, nodes, 3).
    horizon: frames. knots: how many velocities the path has; in between they are linear in time.
    grasps: lists of controllers that move together, as those of one hand; default: each by itself.
    max_speed: of a controller, m/s; it is never passed. max_stretch: of a spring, as a part of its
        rest length; more is penalised.
    obstacles: (x, y, z, radius) of spheres, m; nodes and controllers inside are penalised.
    smoothness: weight of changes of velocity. ground, fps, gravity: those of Simulator.
    """

    def __init__(self,
                 twin: _core.Twin | str | os.PathLike,
                 level: int = 0,
                 *,
                 target_points: ArrayLike | None = None,
                 target_nodes: Sequence[int] | None = None,
                 target_cost: Cost | None = None,
                 horizon: int = 30,
                 knots: int = 8,
                 grasps: Sequence[Sequence[int]] | None = None,
                 max_speed: float = 0.5,
                 max_stretch: float = 0.1,
                 obstacles: ArrayLike = (),
                 smoothness: float = 1e-3,
                 **simulator: Any):
        given = twin_of(twin)
        self.simulator = Simulator(given, level, **simulator)
        if (target_points is None) == (target_cost is None):
            raise _core.Error('one of target_points and target_cost is needed')
        whole('horizon', horizon, 1)
        whole('knots', knots, 1)
        number('max_speed', max_speed, 1e-9, 1e3)
        number('max_stretch', max_stretch, 0, 1e6)
        number('smoothness', smoothness, 0, 1e6)
        self._goals: tuple[Any, Array] | None = None  # nodes, and where they should be
        self._target = target_cost or self._towards(np.asarray(target_points, float), target_nodes)
        self.horizon = horizon
        self._basis = hat_functions(horizon, min(knots, horizon))
        count = self.simulator.controller_count
        self._grasps = [[whole('a controller of grasps', c, 0, count - 1) for c in one]
                        for one in ([[c] for c in range(count)] if grasps is None else grasps)]
        if sorted(c for one in self._grasps for c in one) != list(range(count)) or [] in self._grasps:
            raise _core.Error(f'grasps has not each of the {count} controllers once')
        self._max_speed, self._max_stretch = max_speed, max_stretch
        self._smoothness = smoothness
        rows = np.asarray(obstacles, float)
        self._obstacles = _doubles('obstacles', rows.reshape(0, 4) if rows.size == 0 else rows, 2)
        if self._obstacles.shape[1] != 4 or not (np.isfinite(self._obstacles).all() and
                                                 (self._obstacles[:, 3:] > 0).all()):
            raise _core.Error('obstacles has a row of x, y, z and a radius above 0 for each')
        of_level = given.levels[level]
        self._springs, self._rest = of_level.springs.copy(), of_level.rest_length.copy()
        self._size = of_level.position.std(axis=0).max()  # of the object, m: the unit of lengths
        self._left: Array | None = None  # the velocities of the last plan

    def _towards(self, target: Array, nodes: Sequence[int] | None) -> Cost:
        which = np.arange(len(target)) if nodes is None else np.atleast_1d(np.asarray(nodes, int))
        if not np.isfinite(target).any() or len(set(which.tolist())) != len(which) or which.min() < 0:
            raise _core.Error('target_points has no number, or target_nodes names a node twice')
        if target.shape != (len(which), 3) or which.max() >= self.simulator.node_count:
            raise _core.Error(f'target_points has shape {target.shape}, expected one row of three '
                              'for each target node')
        wanted = np.isfinite(target)
        whole = wanted.all(axis=1)
        self._goals = which[whole], target[whole]
        goal = np.where(wanted, target, 0)

        def cost(position: Array) -> tuple[float, Array]:
            off = np.where(wanted, position[-1, which] - goal, 0)
            bar = np.zeros_like(position)
            bar[-1, which] = 2 * off / len(which)
            return float((off**2).sum() / len(which)), bar

        return cost

    def plan(self,
             position: ArrayLike | None = None,
             controllers: ArrayLike | None = None,
             *,
             velocity: ArrayLike | None = None,
             seconds: float = np.inf,
             evaluations: int = 300,
             begin_with: Array | None = None) -> Plan:
        """A path from here: nodes at `position` (nodes, 3) with `velocity`, controllers at
        `controllers` (controllers, 3); the reference configuration where they are not given. Ends
        when nothing is gained any more, or after so many seconds or evaluations. `begin_with`: a
        path (T, controllers, 3) to begin with, instead of standing still."""
        start = {'position': position, 'velocity': velocity}
        here = np.array(self.simulator._core.rest_controllers if controllers is None else controllers,
                        float)
        search = Search(self, here, start, time.perf_counter() + seconds, evaluations)
        if begin_with is not None:
            search.go_from(self._fitted(begin_with))
        else:
            first = search.best_of(self._guesses(here, search.position))
            if len(self._obstacles) > 0:
                # from a path straight through them, which they then push aside: one that begins
                # before them stays there
                search.obstacles = False
                first = search.go_from(first, gain=1e-2, share=0.25)
                search.obstacles = True
            search.go_from(first)
        self._left = search.best
        return search.plan()

    def replan(self, position: ArrayLike, controllers: ArrayLike, *, frames: int = 1,
               **how: Any) -> Plan:
        """`plan`, beginning with what is left of the last plan after so many of its frames."""
        if self._left is None:
            return self.plan(position, controllers, **how)
        moved = self._path(np.asarray(controllers, float), self._left)
        shifted = np.concatenate([moved[frames:], np.repeat(moved[-1:], frames, axis=0)])
        return self.plan(position, controllers, begin_with=shifted, **how)

    def _guesses(self, here: Array, position: Array) -> list[Array]:
        """Paths to begin with, as numbers: hands that stay; that carry what they are nearest to
        straight to its place; that do so in an arc, against gravity."""
        still = np.zeros((self._basis.shape[1], len(self._grasps), 3))
        if self._goals is None or len(self._goals[0]) == 0:
            return [still]
        nodes, goals = self._goals
        share = np.linspace(0, 1, self.horizon + 1)
        up = -self.simulator.parameters()['gravity']
        up = up / max(np.linalg.norm(up), 1e-12)
        guesses = [still]
        for height in (0.0, 0.5):
            path = np.repeat(here[None], self.horizon + 1, axis=0)
            for of_grasp in self._grasps:
                away = np.linalg.norm(position[nodes] - here[of_grasp].mean(axis=0), axis=1)
                near = np.argsort(away)[:3]
                way = (goals[near] - position[nodes[near]]).mean(axis=0)
                arc = height * np.linalg.norm(way) * up
                path[:, of_grasp] += (share[:, None] * way +
                                      np.sin(np.pi * share)[:, None] * arc)[:, None]
            guesses.append(self._fitted(path))
        return guesses

    # between numbers without bounds, velocities, and paths

    def _velocities(self, numbers: Array) -> Array:
        """(knots, grasps, 3) velocities, m/s, of numbers of any size: none is above max_speed."""
        size = np.sqrt(1 + (numbers**2).sum(axis=2, keepdims=True))
        return self._max_speed * numbers / size

    def _velocities_bar(self, numbers: Array, bar: Array) -> Array:
        size = np.sqrt(1 + (numbers**2).sum(axis=2, keepdims=True))
        along = (numbers * bar).sum(axis=2, keepdims=True)
        return self._max_speed * (bar / size - numbers * along / size**3)

    def _path(self, here: Array, numbers: Array) -> Array:
        """(T, controllers, 3)."""
        steps = np.tensordot(self._basis, self._velocities(numbers), 1) / self.simulator.fps
        moved = np.concatenate([np.zeros((1, *steps.shape[1:])), steps.cumsum(axis=0)])
        path = np.repeat(here[None], self.horizon + 1, axis=0)
        for grasp, of_grasp in enumerate(self._grasps):
            path[:, of_grasp] += moved[:, grasp, None]
        return path

    def _path_bar(self, numbers: Array, bar: Array) -> Array:
        moved_bar = np.stack([bar[:, of_grasp].sum(axis=1) for of_grasp in self._grasps], axis=1)
        steps_bar = moved_bar[1:][::-1].cumsum(axis=0)[::-1] / self.simulator.fps
        return self._velocities_bar(numbers, np.tensordot(self._basis.T, steps_bar, 1))

    def _fitted(self, path: ArrayLike) -> Array:
        """Numbers whose path is nearest to this one's velocities."""
        path = np.asarray(path, float)
        count = self.simulator.controller_count
        if path.shape != (self.horizon + 1, count, 3):
            raise _core.Error(
                f'the path has shape {path.shape}, expected ({self.horizon + 1}, {count}, 3)')
        moved = np.stack([path[:, of_grasp].mean(axis=1) for of_grasp in self._grasps], axis=1)
        speed = np.diff(moved, axis=0) * self.simulator.fps
        knots = np.linalg.lstsq(self._basis, speed.reshape(self.horizon, -1), rcond=None)[0]
        share = knots.reshape(-1, len(self._grasps), 3) / self._max_speed
        size = np.linalg.norm(share, axis=2, keepdims=True)
        share *= np.minimum(1, 0.95 / np.maximum(size, 1e-12))
        return share / np.sqrt(1 - (share**2).sum(axis=2, keepdims=True))

    # penalties, each with its derivatives

    def _stretch(self, position: Array, path: Array) -> tuple[float, Array, Array, float]:
        everything = np.concatenate([position, path], axis=1)
        a, b = self._springs.T
        d = everything[:, b] - everything[:, a]
        length = np.linalg.norm(d, axis=2)
        stretch = length / self._rest - 1
        over = np.maximum(0, stretch - self._max_stretch)
        scale = 1 / len(self._rest)
        pull = (2 * scale * over / self._rest / np.maximum(length, 1e-12))[..., None] * d
        bar = np.zeros_like(everything)
        for frame in range(len(bar)):
            np.add.at(bar[frame], b, pull[frame])
            np.add.at(bar[frame], a, -pull[frame])
        nodes = position.shape[1]
        return (float(scale * (over**2).sum()), bar[:, :nodes], bar[:, nodes:], float(stretch.max()))

    def _collide(self, points: Array, they_count: bool) -> tuple[float, Array]:
        cost, bar = 0.0, np.zeros_like(points)
        for *centre, radius in self._obstacles if they_count else ():
            d = points - centre
            distance = np.linalg.norm(d, axis=2)
            inside = np.maximum(0, radius - distance)
            cost += float((inside**2).sum())
            bar -= (2 * inside / np.maximum(distance, 1e-12))[..., None] * d
        return cost, bar


def plan(twin: _core.Twin | str | os.PathLike,
         target_points: ArrayLike | None = None,
         *,
         target_cost: Cost | None = None,
         level: int = 0,
         position: ArrayLike | None = None,
         controllers: ArrayLike | None = None,
         velocity: ArrayLike | None = None,
         seconds: float = np.inf,
         evaluations: int = 300,
         **how: Any) -> Plan:
    """A path for the controllers of a twin: `Planner(...).plan(...)`."""
    planner = Planner(twin, level, target_points=target_points, target_cost=target_cost, **how)
    return planner.plan(position, controllers, velocity=velocity, seconds=seconds,
                        evaluations=evaluations)
