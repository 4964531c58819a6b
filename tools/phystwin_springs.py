# SPDX-License-Identifier: Apache-2.0
"""Searches PhysTwin's springs again.

PhysTwin keeps one Y a spring and not which particles it joins; the springs follow from frame 0, two
radii and two neighbour counts. The search and the order here are PhysTwin's, except that points
equally far from another come by index, where Open3D's order is that of its tree.
"""

import numpy as np

REST_LENGTH_MIN = 1e-4  # m; no two particles nearer than this are joined


def hybrid_search(points, query, radius, max_neighbours):
    """Indices of the nearest `max_neighbours` points nearer than `radius`, nearest first.

    This is Open3D's search_hybrid_vector_3d.
    """
    d = points - query
    squared = d[:, 0] * d[:, 0] + d[:, 1] * d[:, 1] + d[:, 2] * d[:, 2]
    near = np.flatnonzero(squared < radius * radius)
    return near[np.argsort(squared[near], kind="stable")][:max_neighbours]


def find_springs(particles, controllers, parameters):
    """PhysTwin's springs: (springs, rest lengths, how many of them join two particles)."""
    positions = np.concatenate([particles, controllers]).astype(np.float64)
    particles = positions[:len(particles)]
    springs, joined = [], set()
    for i, point in enumerate(particles):
        found = hybrid_search(particles, point, parameters["object_radius"],
                              parameters["object_max_neighbours"])
        for j in found[1:].tolist():  # the first is the particle itself
            pair = (min(i, j), max(i, j))
            if pair not in joined and np.linalg.norm(point - particles[j]) > REST_LENGTH_MIN:
                joined.add(pair)
                springs.append((i, j))
    object_springs = len(springs)
    for i in range(len(particles), len(positions)):
        found = hybrid_search(particles, positions[i], parameters["controller_radius"],
                              parameters["controller_max_neighbours"])
        springs += [(i, j) for j in found.tolist()]
    springs = np.array(springs, np.int32).reshape(-1, 2)
    rest_length = np.linalg.norm(positions[springs[:, 1]] - positions[springs[:, 0]], axis=1)
    return springs, rest_length, object_springs
