# SPDX-License-Identifier: Apache-2.0
"""The costs of the paths of a planner, and the search among them."""
from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from physpring import _core
from physpring._simulation import _start

if TYPE_CHECKING:
    from physpring.planning import Planner

Array = NDArray[np.float64]

_FIRM = 100.0  # weight of penalties against the target


@dataclasses.dataclass(frozen=True)
class Plan:
    """A path, and what it is expected to do."""
    controllers: Array  #: (T, controllers, 3) where they go, m; frame 0 is where they are
    position: Array  #: (T, nodes, 3) where the nodes then are, m
    cost: float  #: of the path, with all penalties
    target_cost: float  #: of what is wanted alone
    stretch: float  #: the most that a spring is longer than at rest, as a part of it
    evaluations: int  #: rollouts, with their gradients
    seconds: float
    converged: bool  #: L-BFGS found no better path; else time or evaluations ran out


class _Enough(Exception):
    """The time, or the number of evaluations, is up."""


class Search:
    """The costs of paths from one place, and the best one so far."""

    def __init__(self, planner: Planner, here: Array, start: dict[str, Any], until: float,
                 evaluations: int):
        self._planner, self._here, self._start = planner, here, start
        self._until, self._most = until, evaluations
        self._began = time.perf_counter()
        self.evaluations, self.converged = 0, False
        self.obstacles = True  # whether they count
        self.best: Array | None = None
        self._best: tuple[float, float, Array, Array, float] | None = None

    @property
    def position(self) -> Array:
        """(nodes, 3) where they are at the start."""
        return self._planner.simulator._core.nodes(self._planner.simulator._core.start(
            self._here, *_start(self._start['position'], None)))[0]

    def best_of(self, guesses: Sequence[Array]) -> Array:
        """The one with the least cost."""
        if len(guesses) == 1:
            return guesses[0]
        return guesses[int(np.argmin([self.value(guess.ravel()) for guess in guesses]))]

    def go_from(self, numbers: Array, gain: float = 1e-7, share: float = 1) -> Array:
        """The best numbers that a descent from these ones finds, until a step gains a smaller part
        of the cost, or this share of time and evaluations is up."""
        from scipy.optimize import minimize  # pylint: disable=import-outside-toplevel
        self.best, self._best = None, None  # of other costs
        self.converged = False
        whole = self._until, self._most
        self._until = self._began + share * (self._until - self._began)
        self._most = int(share * self._most)
        try:
            done = minimize(self.cost, numbers.ravel(), jac=True, method='L-BFGS-B',
                            options={'maxfun': whole[1], 'maxiter': whole[1], 'maxcor': 20,
                                     'ftol': gain, 'gtol': 1e-9})
            self.converged = bool(done.success)
        except _Enough:
            pass
        self._until, self._most = whole
        assert self.best is not None
        return self.best

    def value(self, flat: Array) -> float:
        """The cost alone."""
        moved = self._move(flat)
        return np.inf if moved is None else self._judge(*moved)[0]

    def cost(self, flat: Array) -> tuple[float, Array]:
        """The cost and its derivatives, for L-BFGS."""
        enough = time.perf_counter() > self._until or self.evaluations >= self._most
        if self._best is not None and enough:
            raise _Enough
        moved = self._move(flat)
        if moved is None:
            if self._best is None:
                raise _core.Error('the motion diverges; more sub-steps are needed')
            return 1e6 * (1 + abs(self._best[0])), np.zeros_like(flat)
        numbers, path, _ = moved
        total, nodes_bar, hands_bar, velocities_bar = self._judge(*moved)
        planner = self._planner
        gradient = planner.simulator.vjp(path, nodes_bar, **self._start)
        bar = planner._path_bar(numbers, gradient['controllers'] + hands_bar)
        return total, (bar + planner._velocities_bar(numbers, velocities_bar)).ravel()

    def _move(self, flat: Array) -> tuple[Array, Array, Array] | None:
        """Numbers, path and motion; None where that diverges: such a path is none."""
        numbers = flat.reshape(self._planner._basis.shape[1], -1, 3)
        path = self._planner._path(self._here, numbers)
        self.evaluations += 1
        try:
            return numbers, path, self._planner.simulator.rollout(path, **self._start)[0]
        except _core.Error:
            return None

    def _judge(self, numbers: Array, path: Array, position: Array) -> tuple[float, Array, Array, Array]:
        """The cost, and its derivatives with respect to nodes, hands and velocities."""
        planner = self._planner
        unit = planner._size**-2
        wanted, wanted_bar = planner._target(position)
        if not np.isfinite(wanted) or np.shape(wanted_bar) != position.shape:
            raise _core.Error('target_cost gave a cost that is not finite, or derivatives of the shape '
                              f'{np.shape(wanted_bar)}, expected {position.shape}')
        stretched, by_nodes, by_hands, most = planner._stretch(position, path)
        hit, hit_nodes = planner._collide(position, self.obstacles)
        hit_hand, hit_hands = planner._collide(path, self.obstacles)
        change = np.diff(planner._velocities(numbers), axis=0) / planner._max_speed
        total = (unit * (wanted + _FIRM * (hit + hit_hand)) + _FIRM * stretched +
                 planner._smoothness * float((change**2).sum()))
        if self._best is None or total < self._best[0]:
            self.best = numbers.copy()
            self._best = (total, wanted, path, position, most)
        velocities_bar = np.zeros_like(numbers)
        velocities_bar[1:] += change
        velocities_bar[:-1] -= change
        velocities_bar *= 2 * planner._smoothness / planner._max_speed
        return (total, unit * (wanted_bar + _FIRM * hit_nodes) + _FIRM * by_nodes,
                unit * _FIRM * hit_hands + _FIRM * by_hands, velocities_bar)

    def plan(self) -> Plan:
        assert self._best is not None
        total, wanted, path, position, most = self._best
        return Plan(path, position, total, wanted, most, self.evaluations,
                    time.perf_counter() - self._began, self.converged)


def hat_functions(frames: int, knots: int) -> Array:
    """(frames, knots) weights of linear interpolation."""
    at = np.linspace(0, max(knots - 1, 0), frames)
    return np.maximum(0, 1 - np.abs(at[:, None] - np.arange(knots)))
