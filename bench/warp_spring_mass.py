#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times the twin's sub-step, written in NVIDIA Warp, on Warp's CPU backend: float32, one thread.

Level 0 of a twin file starts at rest in its reference position, on the ground z = 0, and falls for
some sub-steps; the loss is the sum of |x_i - x_i(0)|^2 at the end. The kernels are PhysTwin's:
springs, whose parameter is ln Y, and dashpots by atomic adds, then velocity with gravity and drag,
then ground contact and position; every sub-step's state is kept for the adjoint. As in PhysTwin,
forward and forward + backward are each recorded once as a graph and replayed, so that no time goes
into Python. --lean replaces ln Y by the stiffness itself: the same force without exp and division.

Prints one line of JSON. Times are CPU times of the thread; cpu_per_wall shows that there is one.
"""

import argparse
import json
import statistics
import time

import numpy as np
import warp as wp


@wp.kernel
def add_spring_forces(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3),
                      springs: wp.array(dtype=wp.vec2i), stiffness: wp.array(dtype=float),
                      rest_length: wp.array(dtype=float), dashpot: wp.array(dtype=float),
                      f: wp.array(dtype=wp.vec3)):
    e = wp.tid()
    a = springs[e][0]
    b = springs[e][1]
    d = x[b] - x[a]
    length = wp.length(d)
    n = d / wp.max(length, 1.0e-6)
    pull = stiffness[e] * (length - rest_length[e]) + dashpot[e] * wp.dot(v[b] - v[a], n)
    wp.atomic_add(f, a, pull * n)
    wp.atomic_sub(f, b, pull * n)


@wp.kernel
def add_phystwin_spring_forces(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3),
                               springs: wp.array(dtype=wp.vec2i), log_Y: wp.array(dtype=float),
                               rest_length: wp.array(dtype=float), dashpot: wp.array(dtype=float),
                               f: wp.array(dtype=wp.vec3)):
    e = wp.tid()
    a = springs[e][0]
    b = springs[e][1]
    d = x[b] - x[a]
    length = wp.length(d)
    n = d / wp.max(length, 1.0e-6)
    Y = wp.clamp(wp.exp(log_Y[e]), 0.0, 1.0e5)
    pull = Y * (length / rest_length[e] - 1.0) + dashpot[e] * wp.dot(v[b] - v[a], n)
    wp.atomic_add(f, a, pull * n)
    wp.atomic_sub(f, b, pull * n)


@wp.kernel
def update_velocity(v: wp.array(dtype=wp.vec3), f: wp.array(dtype=wp.vec3),
                    mass: wp.array(dtype=float), gravity: wp.vec3, h: float, drag: float,
                    v_new: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    v_new[i] = (v[i] + h * (f[i] / mass[i] + gravity)) * wp.exp(-h * drag)


@wp.kernel
def touch_ground_and_move(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3),
                          restitution: wp.array(dtype=float), friction: wp.array(dtype=float),
                          h: float, x_new: wp.array(dtype=wp.vec3), v_new: wp.array(dtype=wp.vec3)):
    i = wp.tid()
    v1 = v[i]
    if x[i][2] + h * v1[2] < 0.0 and v1[2] < -1.0e-4:
        e = restitution[0]
        normal = wp.vec3(0.0, 0.0, v1[2])
        tangent = v1 - normal
        stop = friction[0] * (1.0 + e) * wp.length(normal) / wp.max(wp.length(tangent), 1.0e-6)
        v1 = wp.max(0.0, 1.0 - stop) * tangent - e * normal
    x_new[i] = x[i] + h * v1
    v_new[i] = v1


@wp.kernel
def add_squared_distances(x: wp.array(dtype=wp.vec3), target: wp.array(dtype=wp.vec3),
                          loss: wp.array(dtype=float)):
    i = wp.tid()
    d = x[i] - target[i]
    wp.atomic_add(loss, 0, wp.dot(d, d))


class Rollout:
    """One rollout of a twin's level 0: parameters, states of all sub-steps, launches."""

    def __init__(self, twin, substeps, lean):
        level = {name: twin["level0/" + name] for name in (
            "position", "springs", "stiffness", "rest_length", "dashpot", "mass", "drag",
            "restitution", "friction", "substeps_per_second")}
        self.substeps = substeps
        self.nodes = len(level["mass"])
        self.h = 1.0 / float(level["substeps_per_second"])  # s
        self.gravity = wp.vec3(*(float(g) for g in twin["gravity"]))
        self.drag = float(level["drag"])
        self.springs = wp.array(level["springs"], dtype=wp.vec2i)
        self.rest_length = wp.array(level["rest_length"], dtype=float)
        self.dashpot = wp.array(level["dashpot"], dtype=float)
        self.mass = wp.array(level["mass"], dtype=float)
        # what PhysTwin learns
        Y = level["stiffness"] * level["rest_length"]  # N
        self.add_spring_forces = add_spring_forces if lean else add_phystwin_spring_forces
        self.spring = wp.array(level["stiffness"] if lean else np.log(Y), dtype=float,
                               requires_grad=True)
        self.restitution = wp.array([level["restitution"]], dtype=float, requires_grad=True)
        self.friction = wp.array([level["friction"]], dtype=float, requires_grad=True)

        self.start = wp.array(level["position"], dtype=wp.vec3)
        self.x = [self._vectors() for _ in range(substeps + 1)]
        self.v = [self._vectors() for _ in range(substeps + 1)]
        self.v_free = [self._vectors() for _ in range(substeps)]
        self.f = [self._vectors() for _ in range(substeps)]
        self.x[0].assign(level["position"])
        self.loss = wp.zeros(1, dtype=float, requires_grad=True)

    def _vectors(self):
        return wp.zeros(self.nodes, dtype=wp.vec3, requires_grad=True)

    def forward(self):
        self.loss.zero_()
        for i in range(self.substeps):
            self.f[i].zero_()
            wp.launch(self.add_spring_forces, dim=len(self.springs),
                      inputs=[self.x[i], self.v[i], self.springs, self.spring, self.rest_length,
                              self.dashpot], outputs=[self.f[i]])
            wp.launch(update_velocity, dim=self.nodes,
                      inputs=[self.v[i], self.f[i], self.mass, self.gravity, self.h, self.drag],
                      outputs=[self.v_free[i]])
            wp.launch(touch_ground_and_move, dim=self.nodes,
                      inputs=[self.x[i], self.v_free[i], self.restitution, self.friction, self.h],
                      outputs=[self.x[i + 1], self.v[i + 1]])
        wp.launch(add_squared_distances, dim=self.nodes, inputs=[self.x[-1], self.start],
                  outputs=[self.loss])

    def gradient(self):
        for array in [self.spring, self.restitution, self.friction, *self.x, *self.v,
                      *self.v_free, *self.f]:
            array.grad.zero_()
        tape = wp.Tape()
        with tape:
            self.forward()
        tape.backward(self.loss)


def record(launches):
    """A function that replays `launches` without Python."""
    launches()  # compiles the kernels, which cannot be recorded
    with wp.ScopedCapture() as capture:
        launches()
    return lambda: wp.capture_launch(capture.graph)


def time_of(run, repeats):
    """(median CPU time of a run in seconds, CPU time / wall time)"""
    run()
    times, wall = [], time.perf_counter()
    for _ in range(repeats):
        start = time.process_time()  # of all threads
        run()
        times.append(time.process_time() - start)
    return statistics.median(times), sum(times) / (time.perf_counter() - wall)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.
                                     RawDescriptionHelpFormatter)
    parser.add_argument("twin", help="NAME.twin.npz, without controllers")
    parser.add_argument("--substeps", type=int, default=200, help="of a rollout (default 200)")
    parser.add_argument("--repeats", type=int, default=5, help="median of so many (default 5)")
    parser.add_argument("--lean", action="store_true", help="springs by stiffness, not by ln Y")
    args = parser.parse_args()

    wp.config.quiet = True
    wp.set_device("cpu")
    with np.load(args.twin) as twin:
        rollout = Rollout(twin, args.substeps, args.lean)
    forward, cpu_per_wall = time_of(record(rollout.forward), args.repeats)
    gradient, _ = time_of(record(rollout.gradient), args.repeats)
    print(json.dumps({
        "program": f"warp {wp.__version__} cpu", "precision": "float", "lean": args.lean,
        "nodes": rollout.nodes, "springs": len(rollout.springs), "substeps": args.substeps,
        "us_per_substep_forward": forward * 1e6 / args.substeps,
        "us_per_substep_gradient": gradient * 1e6 / args.substeps,
        "cpu_per_wall": cpu_per_wall,
        "loss": float(rollout.loss.numpy()[0]),
    }))


if __name__ == "__main__":
    main()
