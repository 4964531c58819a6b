# SPDX-License-Identifier: Apache-2.0
"""JAX: the motion of a twin as a differentiable function.

    import physpring.jax
    rollout = physpring.jax.rollout(physpring.Simulator(twin))
    def loss(stiffness):
        position, velocity = rollout(controllers, stiffness=stiffness)
        return ((position[-1] - target) ** 2).sum()
    jax.grad(loss)(stiffness)

The forward pass and the gradient are computed by physpring on the CPU, in double, and called from
compiled code by jax.pure_callback. Results are float64 where jax_enable_x64 is on, else float32.
Only reverse-mode first derivatives are available; vmap calls one after the other.
"""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from physpring import _core
from physpring._simulation import Simulator

_START = ('position', 'velocity')


def rollout(simulator: Simulator) -> Callable[..., tuple[jax.Array, jax.Array]]:
    """A function of `controllers` (T, controllers, 3) and, by name, of the start (`position`,
    `velocity`) and of any of Simulator.parameters(). It gives positions and velocities,
    (T, nodes, 3). The simulator is taken as it is now."""
    fixed = simulator.with_parameters()
    known = set(_START) | set(fixed.parameters())

    def move(controllers: Any, values: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
        start, changed = _split(values)
        moved = fixed.with_parameters(**changed).rollout(np.asarray(controllers, float), **start)
        return tuple(part.astype(_real()) for part in moved)  # type: ignore

    def move_back(controllers: Any, values: dict[str, Any], bars: Any) -> Any:
        start, changed = _split(values)
        gradient = fixed.with_parameters(**changed).vjp(
            np.asarray(controllers, float), np.asarray(bars[0], float), np.asarray(bars[1], float),
            **start)
        taken = {name: np.asarray(gradient[name], dtype=np.asarray(value).dtype).reshape(
            np.shape(value)) for name, value in values.items()}
        return gradient['controllers'].astype(np.asarray(controllers).dtype), taken

    @jax.custom_vjp
    def call(controllers: jax.Array, values: dict[str, jax.Array]) -> Any:
        shape = jax.ShapeDtypeStruct((controllers.shape[0], fixed.node_count, 3), _real())
        return jax.pure_callback(move, (shape, shape), controllers, values,
                                 vmap_method='sequential')

    def forward(controllers: jax.Array, values: dict[str, jax.Array]) -> Any:
        return call(controllers, values), (controllers, values)

    def backward(saved: Any, bars: Any) -> Any:
        controllers, values = saved
        shapes = jax.tree.map(lambda one: jax.ShapeDtypeStruct(one.shape, one.dtype),
                              (controllers, values))
        return jax.pure_callback(move_back, shapes, controllers, values, bars,
                                 vmap_method='sequential')

    call.defvjp(forward, backward)

    def rolled(controllers: Any, **values: Any) -> tuple[jax.Array, jax.Array]:
        for name in values:
            if name not in known:
                raise _core.Error(f'{name!r} is no parameter; there are {", ".join(sorted(known))}')
        return call(jnp.asarray(controllers, _real()),
                    {name: jnp.asarray(value, _real()) for name, value in values.items()})

    return rolled


def _real() -> Any:
    return jnp.zeros(0).dtype  # float64 where jax_enable_x64 is on


def _split(values: dict[str, Any]) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Start and parameters, as arrays of doubles."""
    arrays = {name: np.asarray(value, float) for name, value in values.items()}
    start = {name: arrays.pop(name) for name in _START if name in arrays}
    return start, arrays
