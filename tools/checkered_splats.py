#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Splats to try with, where there are no photographs: checkered_splats.py TWIN.twin.npz OUT.ply

They cover the box about the twin's level 0 in its reference configuration, in two colours.
"""
import argparse
import math
import pathlib
import zipfile

import numpy as np

CHECK = 0.012  # m
COLOURS = np.array([[0.95, 0.55, 0.1], [0.1, 0.35, 0.8]])
COLUMNS = ('x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 '
           'rot_3').split()
HARMONIC = 0.28209479177387814  # the constant one


def box_of(twin):
    """Corners (3,) of the box about the nodes, m."""
    with np.load(twin) as arrays:
        nodes = arrays['level0/position'][:len(arrays['level0/mass'])]  # then come controllers
    return nodes.min(0), nodes.max(0)


def points_on(low, high, count):
    """(count, 3), evenly on the six faces."""
    random = np.random.default_rng(0)
    size = high - low
    area = np.array([size[1] * size[2], size[2] * size[0], size[0] * size[1]])
    axis = random.choice(3, count, p=area / area.sum())
    share = random.uniform(0, 1, (count, 3))
    share[np.arange(count), axis] = random.integers(0, 2, count)
    return low + share * size, math.sqrt(2 * area.sum() / count)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('twin', help='of a block-shaped object')
    parser.add_argument('output', type=pathlib.Path, help='.ply to write')
    parser.add_argument('--count', type=int, default=20000, help='of splats, to 4000000; default 20000')
    parser.add_argument('--force', action='store_true', help='overwrite a file')
    arguments = parser.parse_args()
    if not 1 <= arguments.count <= 4000000:
        parser.error(f'--count is {arguments.count}, expected 1 to 4000000')
    if arguments.output.exists() and not arguments.force:
        parser.error(f'{arguments.output}: is there already (--force)')
    try:
        low, high = box_of(arguments.twin)
    except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
        parser.error(f'{arguments.twin}: is no twin: {error}')
    places, gap = points_on(low, high, arguments.count)
    check = np.floor(places / CHECK).sum(1).astype(int) % 2
    rows = np.zeros((arguments.count, len(COLUMNS)), '<f4')
    rows[:, :3] = places
    rows[:, 3:6] = (COLOURS[check] - 0.5) / HARMONIC
    rows[:, 6] = 4
    rows[:, 7:10] = math.log(0.7 * gap)
    rows[:, 10] = 1
    header = ['ply', 'format binary_little_endian 1.0', f'element vertex {arguments.count}',
              *(f'property float {name}' for name in COLUMNS), 'end_header', '']
    try:
        write(arguments.output, header, rows)
    except OSError as error:
        parser.error(f'{arguments.output}: cannot be written: {error}')


def write(path, header, rows):
    path.write_bytes('\n'.join(header).encode() + rows.tobytes())


if __name__ == '__main__':
    main()
