#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Twins from clouds of a recording, against twins from its points.

The names of the points are thrown away. Each frame's cloud is 60 % of them, drawn anew, with 2 mm of
noise; with --one-side only of those that a camera at one side sees (hidden point removal, Katz et al.
2007). `physpring register` makes points of the clouds, `physpring train` twins of both. With --known
the places of all points in frame 0 are known, as from a scan, and the particles are there
(`register --like`); else they are spread over the first cloud. The blind predictions are judged at the
recording's own points, which are carried along by the eight nearest particles, as a rigid body; with
--known they are those particles.

What is there already is not made again. Needs numpy and scipy.
"""
import argparse
import itertools
import pathlib
import sys

import numpy as np
from one_camera import ROOT, carried, run
from scipy.spatial import ConvexHull

KEPT, NOISE = 0.6, 2e-3  # part of the points, m
EYE = np.array([-0.4, -0.9, 0.5])  # where the camera is, seen from the object; any length
DISTANCE, FLIP = 1.5, 30.0  # of the camera, m; radius of the flipping sphere in distances


def seen_from(points, eye):
    """Which of the points (N, 3) are not behind others."""
    rays = points - eye
    lengths = np.linalg.norm(rays, axis=1, keepdims=True)
    flipped = rays + 2 * (FLIP * lengths.max() - lengths) * rays / lengths
    hull = ConvexHull(np.vstack([flipped, np.zeros(3)])).vertices
    seen = np.zeros(len(points) + 1, bool)
    seen[hull] = True
    return seen[:-1]


def clouds(recording, one_side):
    """(T, S, 3), filled up with NaN."""
    random = np.random.default_rng(7)
    eye = np.nanmean(recording['points'], axis=(0, 1)) + DISTANCE * EYE / np.linalg.norm(EYE)
    found = []
    for frame in recording['points'].astype(float):
        frame = frame[np.isfinite(frame).all(axis=1)]
        if one_side:
            frame = frame[seen_from(frame, eye)]
        frame = frame[random.random(len(frame)) < KEPT]
        found.append(frame + NOISE * random.standard_normal(frame.shape))
    cloud = np.full((len(found), max(map(len, found)), 3), np.nan, np.float32)
    for row, frame in zip(cloud, found):
        row[:len(frame)] = frame
    return cloud


def first_frame(names):
    """A recording of frame 0 alone, twice."""
    kept = {key: value for key, value in names.items()
            if key in ('fps', 'mass', 'gravity', 'ground')}
    return {**kept, **{key: np.repeat(names[key][:1], 2, axis=0)
                       for key in ('points', 'controllers')}}


def moved_as(places, motion, known):
    """Where places (n, 3) of frame 0 are moved to: by the particle there, or by those near it."""
    nearest = np.linalg.norm(places[:, None] - motion[0], axis=2).argmin(axis=1)
    if known and len(set(nearest)) == len(places):
        return motion[:, nearest]
    return carried(places, motion[0], motion)


def errors(program, twin, recording, names, known):
    """Mean distances in the fit frames and in later ones, mm, a row for each level."""
    path = twin.with_suffix('.motion.npz')
    run(program, 'eval', twin, recording, '--trajectory', path)
    motion, points = np.load(path), names['points'].astype(float)
    fit = int(names['train_frames']) if 'train_frames' in names else int(0.7 * len(points))
    found = []
    for level in itertools.count():
        if f'level{level}/points' not in motion:
            return found
        moved = motion[f'level{level}/points'].astype(float)
        at_start = np.isfinite(points[0]).all(axis=1)
        apart = moved_as(points[0][at_start], moved, known) - points[:, at_start]
        apart = np.nanmean(np.linalg.norm(apart, axis=2), axis=1)
        found.append((1e3 * apart[:fit].mean(), 1e3 * apart[fit:].mean()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('output', type=pathlib.Path)
    parser.add_argument('recordings', nargs='+', type=pathlib.Path)
    parser.add_argument('--physpring', default=ROOT / 'build/release/physpring')
    parser.add_argument('--one-side', action='store_true', help='the clouds show one side only')
    parser.add_argument('--known', action='store_true', help='all points are known in frame 0')
    parser.add_argument('--refine', action='store_true', help='as of physpring register')
    parser.add_argument('--levels', default='1')
    options = parser.parse_args()
    print('| recording | level | fit frames, mm | later frames, mm |\n|---|---|---|---|')
    for source in options.recordings:
        names = dict(np.load(source))
        folder = options.output / source.stem
        folder.mkdir(parents=True, exist_ok=True)
        registered = folder / 'registered.npz'
        if not registered.exists():
            others = {key: value for key, value in names.items()
                      if key not in ('points', 'interior', 'track')}
            np.savez(folder / 'clouds.npz', surface=clouds(names, options.one_side), **others)
            how = ['--refine'] if options.refine else []
            if options.known:
                np.savez(folder / 'shape.npz', **first_frame(names))
                how += ['--like', folder / 'shape.npz']
            run(options.physpring, 'register', folder / 'clouds.npz', *how, '-o', registered)
        for recording, name in ((source, 'named'), (registered, 'registered')):
            twin = folder / f'{name}.twin.npz'
            if not twin.exists():
                run(options.physpring, 'train', recording, '-o', twin, '--levels', options.levels)
            for level, (fit, later) in enumerate(errors(
                    options.physpring, twin, recording, names,
                    options.known or recording == source)):
                print(f'| {source.stem}, {name} | {level} | {fit:.2f} | {later:.2f} |',
                      flush=True)


if __name__ == '__main__':
    sys.exit(main())
