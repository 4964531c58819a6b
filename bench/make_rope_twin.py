#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the twin that the benchmarks simulate: 2,000 nodes at random in a rope, 30,000 springs.

Nodes are at least 5 mm apart, in random order; every node is joined to its nearest neighbours, the
shortest of those springs are kept. PhysTwin's usual values: Y = 3e4 N, dashpot 100, drag 3 at 1 kg
a node, 667 sub-steps a frame of 1/30 s. Equal arguments give equal files.
"""

import argparse
import json

import numpy as np

LENGTH, RADIUS, APART = 1.0, 0.02, 0.005  # m
MASS = 0.1  # kg
FPS, SUBSTEPS = 30, 667


def scatter(nodes, random):
    """Points in a cylinder along x that rests on the ground z = 0, none nearer than APART."""
    points = np.empty((0, 3))
    while len(points) < nodes:
        radius, angle = RADIUS * np.sqrt(random.random()), 2 * np.pi * random.random()
        point = np.array([LENGTH * random.random(), radius * np.cos(angle), radius * np.sin(angle)])
        if not (np.sum((points - point) ** 2, axis=1) < APART ** 2).any():
            points = np.vstack([points, point])
    return points - [0, 0, points[:, 2].min()]


def join(points, count):
    """The `count` shortest springs of the smallest k-nearest-neighbour graph that has as many."""
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    nearest = np.argsort(distance, axis=1, kind="stable")
    for k in range(1, len(points)):
        ends = np.stack([np.repeat(np.arange(len(points)), k), nearest[:, 1:k + 1].ravel()], axis=1)
        springs = np.unique(np.sort(ends, axis=1), axis=0)
        if len(springs) >= count:
            break
    length = distance[springs[:, 0], springs[:, 1]]
    kept = np.sort(np.argsort(length, kind="stable")[:count])
    return springs[kept], length[kept]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", help="NAME.twin.npz")
    parser.add_argument("--nodes", type=int, default=2000)
    parser.add_argument("--springs", type=int, default=30000)
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()

    position = scatter(args.nodes, np.random.default_rng(args.seed))
    springs, length = join(position, args.springs)
    mass = MASS / args.nodes
    meta = {"format": "physpring twin", "version": 1, "program": "make_rope_twin", "name": "rope",
            "levels": 1, "points": args.nodes, "interior": 0, "controllers": 0,
            "controller_velocity": True, "recordings": [], "seed": args.seed, "options": {}}
    level = {
        "position": position, "mass": np.full(args.nodes, mass),
        "springs": springs.astype(np.int32),
        "stiffness": 3e4 * mass / length, "rest_length": length,
        "dashpot": np.full(len(springs), 100 * mass), "drag": 3.0,
        "contact_radius": np.zeros(args.nodes), "restitution": 0.5, "friction": 0.3,
        "object_restitution": 0.7, "object_friction": 0.3, "collision_distance": 0.0,
        "substeps_per_second": np.int32(SUBSTEPS * FPS)}
    np.savez(args.output, meta=np.frombuffer(json.dumps(meta).encode(), np.uint8),
             fps=float(FPS), gravity=np.array([0, 0, -9.81]),
             **{"level0/" + name: np.asarray(values) for name, values in level.items()})


if __name__ == "__main__":
    main()
