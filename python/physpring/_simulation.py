# SPDX-License-Identifier: Apache-2.0
"""A level of a twin moved along a path that was not recorded, and its gradient."""
from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from physpring import _core
from physpring._recordings import number, precision_of, twin_of, whole

Array = NDArray[np.float64]


def _doubles(name: str, value: ArrayLike, dimensions: int) -> Array:
    """An array of doubles in C order. The engine checks its extents."""
    try:
        given = np.asarray(value)
        if given.dtype.kind not in 'fiuO' or np.ma.isMaskedArray(value):
            raise TypeError(f'it is of {given.dtype}' if given.dtype.kind not in 'fiuO' else 'it is masked')
        array = np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise _core.Error(f'{name} is no array of numbers: {error}') from None
    if array.ndim != dimensions:
        raise _core.Error(f'{name} has shape {array.shape}, expected {dimensions} dimensions')
    return array


def _given(name: str, value: ArrayLike | None, dimensions: int) -> Array | None:
    """The same of what may be missing."""
    return None if value is None else _doubles(name, value, dimensions)


def _start(position: ArrayLike | None, velocity: ArrayLike | None) -> tuple[Any, Any]:
    return _given('position', position, 2), _given('velocity', velocity, 2)


class Simulator:
    """Simulates one level of a twin, frame by frame or along a whole path.

    It copies the level: later changes of the twin do not reach it, `set` does. The motion is that
    of `predict`, bit for bit, where path, start and surroundings are those of a recording.

        simulator = physpring.Simulator(twin, level=3)
        simulator.reset()
        for hands in path:                       # (controllers, 3) each, m
            position = simulator.step(hands)     # (nodes, 3)

    twin: a Twin or its file. fps: frames per second, default: the twin's. substeps: of a frame;
    default: as many as are stable, no longer than in training. gravity: (3,) m/s^2, default: the
    twin's. ground: (4,) a, b, c, d of the plane a x + b y + c z = d, None for no ground; default:
    the twin's. precision: 'double' or 'float'.
    """

    def __init__(self,
                 twin: _core.Twin | str | os.PathLike,
                 level: int = 0,
                 *,
                 fps: float | None = None,
                 substeps: int | None = None,
                 gravity: ArrayLike | None = None,
                 ground: ArrayLike | str | None = 'twin',
                 precision: str = 'double'):
        of_twin = isinstance(ground, str)
        if of_twin and ground != 'twin':
            raise _core.Error(f"ground is {ground!r}, expected four numbers, None or 'twin'")
        whole('level', level, 0)
        if fps is not None:
            number('fps', fps, 0.1, 1e5)
        if substeps is not None:
            whole('substeps', substeps, 1, 10**6)
        self._core = _core.LevelSimulator(twin_of(twin), level, fps, substeps,
                                          _given('gravity', gravity, 1),
                                          None if of_twin else _given('ground', ground, 1), of_twin,
                                          precision_of(precision))
        self._state: _core.SimulatorState | None = None

    @property
    def fps(self) -> float:
        """Frames per second."""
        return self._core.fps

    @property
    def substeps(self) -> int:
        """Sub-steps of a frame."""
        return self._core.substeps

    @property
    def node_count(self) -> int:
        return self._core.node_count

    @property
    def controller_count(self) -> int:
        return self._core.controller_count

    # parameters

    def parameters(self) -> dict[str, Any]:
        """Everything learnable, by name, copied: stiffness, rest_length, dashpot (springs,); mass
        (nodes,); drag; gravity (3,); friction, restitution and those between particles; the values
        of each effect under its name."""
        return self._core.parameters()

    def set(self, **parameters: ArrayLike) -> None:
        """Changes some of `parameters()`. Raises Error, and changes none, where one is wrong. The
        state stays."""
        self._core.set({name: _doubles(name, np.atleast_1d(np.asarray(value)), 1)
                        for name, value in parameters.items()})

    def with_parameters(self, **parameters: ArrayLike) -> Simulator:
        """A copy with some of `parameters()` changed, at its start."""
        other = Simulator.__new__(Simulator)
        other._core = self._core.copy()
        other._state = None
        if parameters:
            other.set(**parameters)
        return other

    # frame by frame

    def reset(self,
              *,
              position: ArrayLike | None = None,
              velocity: ArrayLike | None = None,
              controllers: ArrayLike | None = None) -> Array:
        """Starts anew and returns where the nodes are. position, velocity: (nodes, 3), default: the
        reference configuration, at rest. controllers: (controllers, 3), default: their reference."""
        if controllers is None:
            controllers = self._core.rest_controllers
        self._state = self._core.start(_doubles('controllers', controllers, 2),
                                       *_start(position, velocity))
        return self.position

    def step(self, controllers: ArrayLike | None = None) -> Array:
        """Goes on by one frame, in which the controllers move to `controllers`, (controllers, 3),
        on straight lines (None: they stay). Returns where the nodes are then, (nodes, 3), m."""
        state = self.state
        end = state.controllers if controllers is None else _doubles('controllers', controllers, 2)
        self._state = self._core.advance(state, end)
        return self.position

    @property
    def state(self) -> _core.SimulatorState:
        """Where it is now. Setting it goes on from there: states are never changed, so one may be
        kept and tried from many times, or pickled."""
        if self._state is None:
            self.reset()
        assert self._state is not None
        return self._state

    @state.setter
    def state(self, state: _core.SimulatorState) -> None:
        if not isinstance(state, _core.SimulatorState):
            raise TypeError(f'a state is a SimulatorState, not {type(state).__name__}')
        self._core.expect_own(state)
        self._state = state

    @property
    def position(self) -> Array:
        """(nodes, 3) m, now."""
        return self._core.nodes(self.state)[0]

    @property
    def velocity(self) -> Array:
        """(nodes, 3) m/s, now."""
        return self._core.nodes(self.state)[1]

    # whole paths

    def rollout(self,
                controllers: ArrayLike,
                *,
                position: ArrayLike | None = None,
                velocity: ArrayLike | None = None) -> tuple[Array, Array]:
        """Positions (T, nodes, 3) [m] and velocities [m/s] along the path `controllers`,
        (T, controllers, 3). Frame 0 is the start, as in `reset`. The state is left alone."""
        return self._core.roll(_doubles('controllers', controllers, 3), *_start(position, velocity))

    def vjp(self,
            controllers: ArrayLike,
            position_bar: ArrayLike,
            velocity_bar: ArrayLike | None = None,
            *,
            position: ArrayLike | None = None,
            velocity: ArrayLike | None = None) -> dict[str, Any]:
        """The gradient of a loss on `rollout`, given its derivatives with respect to positions and
        velocities, (T, nodes, 3) each. A dict: those with respect to all `parameters()`, to the
        start (`position`, `velocity`) and to the path (`controllers`, (T, controllers, 3)). Exact:
        the hand-written adjoint of every sub-step."""
        return self._core.vjp(_doubles('controllers', controllers, 3),
                              _doubles('position_bar', position_bar, 3),
                              _given('velocity_bar', velocity_bar, 3),
                              *_start(position, velocity))


def simulate(twin: _core.Twin | str | os.PathLike,
             controllers: ArrayLike,
             *,
             level: int = 0,
             position: ArrayLike | None = None,
             velocity: ArrayLike | None = None,
             **options: Any) -> Array:
    """Positions (T, nodes, 3) [m] of a level whose controllers move along `controllers`,
    (T, controllers, 3). The start and the options are those of Simulator."""
    return Simulator(twin, level, **options).rollout(controllers, position=position,
                                                     velocity=velocity)[0]
