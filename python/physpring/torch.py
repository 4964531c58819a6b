# SPDX-License-Identifier: Apache-2.0
"""PyTorch: the motion of a twin as a differentiable function.

    import physpring.torch
    simulator = physpring.Simulator(twin)
    stiffness = torch.tensor(simulator.parameters()['stiffness'], requires_grad=True)
    position, velocity = physpring.torch.rollout(simulator, controllers, stiffness=stiffness)
    position[-1].sub(target).square().sum().backward()

The forward pass and the gradient are computed by physpring on the CPU, in double: tensors of other
kinds are converted, and so are the results. Gradients of gradients are not available.
"""
from __future__ import annotations

from typing import Any

import numpy as np
import torch

from physpring import _core
from physpring._simulation import Simulator

_START = ('position', 'velocity')


def rollout(simulator: Simulator,
            controllers: torch.Tensor,
            *,
            position: torch.Tensor | None = None,
            velocity: torch.Tensor | None = None,
            **parameters: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    """Positions and velocities (T, nodes, 3) along the path `controllers`, (T, controllers, 3).

    position, velocity: the start, as in Simulator.rollout. parameters: some of
    Simulator.parameters(), instead of the simulator's values, which stay as they are. Gradients
    flow into every tensor that is given. Results are on the device and of the type of `controllers`.
    """
    given = {'position': position, 'velocity': velocity, **parameters}
    given = {name: value for name, value in given.items() if value is not None}
    known = set(_START) | set(simulator.parameters())
    for name in given:
        if name not in known:
            raise _core.Error(f'{name!r} is no parameter; there are {", ".join(sorted(known))}')
    return _Rollout.apply(simulator, tuple(given), controllers, *given.values())


def _numpy(tensor: Any) -> np.ndarray:
    return torch.as_tensor(tensor).detach().to('cpu', torch.float64).contiguous().numpy()


class _Rollout(torch.autograd.Function):
    """Simulator.rollout and its adjoint."""

    @staticmethod
    def forward(ctx: Any, simulator: Simulator, names: tuple[str, ...], controllers: torch.Tensor,
                *values: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        arrays = {name: _numpy(value) for name, value in zip(names, values)}
        ctx.start = {name: arrays.pop(name) for name in _START if name in arrays}
        ctx.simulator = simulator.with_parameters(**arrays)
        ctx.controllers = _numpy(controllers)
        ctx.names = names
        ctx.like = [(value.dtype, value.device, value.shape) for value in (controllers, *values)]
        moved = ctx.simulator.rollout(ctx.controllers, **ctx.start)
        return tuple(torch.as_tensor(part).to(controllers) for part in moved)  # type: ignore

    @staticmethod
    @torch.autograd.function.once_differentiable
    def backward(ctx: Any, position_bar: torch.Tensor, velocity_bar: torch.Tensor) -> Any:
        gradient = ctx.simulator.vjp(ctx.controllers, _numpy(position_bar), _numpy(velocity_bar),
                                     **ctx.start)
        bars = []
        for name, (dtype, device, shape) in zip(('controllers', *ctx.names), ctx.like):
            bar = torch.as_tensor(np.asarray(gradient[name], dtype=float)).reshape(shape)
            bars.append(bar.to(device=device, dtype=dtype))
        return (None, None, *bars)
