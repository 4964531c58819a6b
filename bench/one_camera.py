#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Twins from what one depth camera sees, against twins from true points: one_camera.py OUTPUT

The demo's rope and cloth, finite elements in MuJoCo, are moved by their hands and filmed: 640 x 480
pixels, depth in millimetres, at 30 fps. Tracks are the projected vertices with 0.3 pixels of noise,
not visible where something is in front of them. tools/sensors_to_npz.py makes recordings of them,
`physpring train` twins. The blind predictions of both are judged at all true vertices, which are
carried along by the eight nearest particles, as a rigid body.

What is there already is not made again. Needs mujoco, pyopengl, numpy and OSMesa.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

os.environ.setdefault('MUJOCO_GL', 'osmesa')
import mujoco
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
WIDTH, HEIGHT, FIELD_OF_VIEW = 640, 480, 45.0  # pixels, degrees
DISTANCE, ELEVATION = 1.15, 20.0  # of the camera, m and degrees
AZIMUTH = {'rope': -60.0, 'cloth': -35.0}  # where it stands, degrees
PIXEL_NOISE, POINT_NOISE = 0.3, 1e-3  # pixels, m
BEHIND = 5e-3  # a vertex so far behind what the camera sees is hidden, m
NEAREST = 8


class Film:
    """The camera of a scene, and what it sees of its flex."""

    def __init__(self, name, points, controllers):
        self.model = mujoco.MjModel.from_xml_path(str(ROOT / f'models/demo/{name}.xml'))
        self.model.vis.global_.offwidth, self.model.vis.global_.offheight = WIDTH, HEIGHT
        self.model.vis.global_.fovy = FIELD_OF_VIEW
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)
        at_rest = self.data.flexvert_xpos.copy()
        self.vertex = [int(np.argmin(np.linalg.norm(at_rest - place, axis=1)))
                       for place in np.concatenate([points[0], controllers[0]])]
        if len(set(self.vertex)) != len(at_rest):
            sys.exit(f'{name}: frame 0 does not show each vertex once')
        middle = np.nanmean(points, axis=(0, 1))
        azimuth, elevation = np.radians(AZIMUTH[name]), np.radians(ELEVATION)
        self.eye = middle + DISTANCE * np.array([np.cos(elevation) * np.cos(azimuth),
                                                 np.cos(elevation) * np.sin(azimuth),
                                                 np.sin(elevation)])
        forward = (middle - self.eye) / DISTANCE
        right = np.cross(forward, [0, 0, 1])
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(forward, right), forward], axis=1)
        self.focal = HEIGHT / 2 / np.tan(np.radians(FIELD_OF_VIEW) / 2)
        self.camera = mujoco.MjvCamera()
        self.camera.lookat[:], self.camera.distance = middle, DISTANCE
        self.camera.azimuth = np.degrees(np.arctan2(forward[1], forward[0]))
        self.camera.elevation = np.degrees(np.arcsin(forward[2]))
        self.renderer = mujoco.Renderer(self.model, HEIGHT, WIDTH)
        self.renderer.enable_depth_rendering()
        hands = np.flatnonzero(self.model.body_mocapid >= 0)
        gaps = np.linalg.norm(controllers[0][:, None] - self.model.body_pos[hands], axis=2)
        self.held = {self.model.body_geomadr[hand]: np.argmin(gaps, axis=1) == i
                     for i, hand in enumerate(hands)}

    def depth(self, points, controllers):
        """The picture of a frame, m."""
        mujoco.mj_forward(self.model, self.data)
        self.data.flexvert_xpos[self.vertex] = np.concatenate([points, controllers])
        for geom, held in self.held.items():
            self.data.geom_xpos[geom] = controllers[held].mean(axis=0)
        self.renderer.update_scene(self.data, self.camera)
        return self.renderer.render().copy()

    def tracks(self, points, depth):
        """Pixels of the points, and which of them are seen."""
        own = (points - self.eye) @ self.axes
        pixels = self.focal * own[:, :2] / own[:, 2:] + [(WIDTH - 1) / 2, (HEIGHT - 1) / 2]
        inside = ((pixels > 2) & (pixels < [WIDTH - 3, HEIGHT - 3])).all(axis=1)
        column, row = np.where(inside, np.rint(pixels).astype(int).T, 2)
        farthest = np.max([depth[row + i, column + j] for i in (-1, 0, 1) for j in (-1, 0, 1)],
                          axis=0)
        return pixels, inside & (farthest > own[:, 2] - BEHIND)

    def json(self):
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = self.axes, self.eye
        return json.dumps({'fx': self.focal, 'fy': self.focal, 'cx': (WIDTH - 1) / 2,
                           'cy': (HEIGHT - 1) / 2, 'camera_to_world': pose.tolist()})


def film(name, truth, folder):
    """Writes depth/, tracks.npz, camera.json and hand.npy."""
    points, controllers = truth['points'].astype(float), truth['controllers'].astype(float)
    view, random = Film(name, points, controllers), np.random.default_rng(5)
    (folder / 'depth').mkdir(parents=True, exist_ok=True)
    tracks, seen = [], []
    for frame, (here, hands) in enumerate(zip(points, controllers)):
        depth = view.depth(here, hands)
        np.save(folder / f'depth/{frame:05}.npy',
                np.rint(1e3 * depth).clip(0, 65535).astype(np.uint16))
        pixels, visible = view.tracks(here, depth)
        tracks.append(pixels + PIXEL_NOISE * random.standard_normal(pixels.shape))
        seen.append(visible)
    (folder / 'camera.json').write_text(view.json())
    np.save(folder / 'hand.npy', controllers)
    np.savez(folder / 'tracks.npz', tracks=np.float32(tracks), visibility=np.array(seen))


def carried(places, start, motion):
    """(T, n, 3): places (n, 3) of the start, carried along by the particles nearest to them."""
    gaps = np.linalg.norm(places[:, None] - start, axis=2)
    near = np.argsort(gaps, axis=1)[:, :NEAREST]
    before = start[near] - start[near].mean(axis=1, keepdims=True)
    arms = places - start[near].mean(axis=1)
    found = []
    for frame in motion:
        middle = frame[near].mean(axis=1, keepdims=True)
        u, _, v = np.linalg.svd(np.swapaxes(before, 1, 2) @ (frame[near] - middle))
        u[:, :, 2] *= np.sign(np.linalg.det(u @ v))[:, None]
        found.append(np.einsum('ni,nij->nj', arms, u @ v) + middle[:, 0])
    return np.array(found)


def errors(program, twin, recording, truth, folder):
    """Mean distances in the fit frames and in later ones, mm."""
    path = folder / 'predicted.npz'
    run(program, 'eval', twin, recording, '--trajectory', path)
    motion = np.load(path)['level0/points']
    points = truth['points']
    apart = np.linalg.norm(carried(points[0], motion[0], motion) - points, axis=2).mean(axis=1)
    fit = int(truth['train_frames'])
    return 1e3 * apart[:fit].mean(), 1e3 * apart[fit:].mean()


def run(*words):
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('output', type=pathlib.Path)
    parser.add_argument('--physpring', default=ROOT / 'build/release/physpring')
    parser.add_argument('--objects', default='rope,cloth')
    options = parser.parse_args()
    print('| recording | fit frames, mm | later frames, mm |\n|---|---|---|')
    for name in options.objects.split(','):
        folder = options.output / name
        folder.mkdir(parents=True, exist_ok=True)
        exact = folder / 'exact.npz'
        if not exact.exists():
            run(options.physpring, 'record', ROOT / f'models/demo/{name}.xml', '-o', exact,
                '--fps', 30, '--noise', 0, '--seed', 1)
        truth = dict(np.load(exact))
        points = folder / 'points.npz'
        if not points.exists():
            noise = POINT_NOISE * np.random.default_rng(1).standard_normal(truth['points'].shape)
            np.savez(points, **{**truth, 'points': np.float32(truth['points'] + noise)})
        tracks = folder / 'tracked.npz'
        if not tracks.exists():
            film(name, truth, folder)
            run(sys.executable, ROOT / 'tools/sensors_to_npz.py', 'tracks', '--view',
                folder / 'tracks.npz', folder / 'depth', folder / 'camera.json', '--controllers',
                folder / 'hand.npy', '--fps', 30, '--mass', float(truth['mass']), '--ground', 0,
                '-o', tracks)
        for recording in (points, tracks):
            twin = recording.with_suffix('.twin.npz')
            if not twin.exists():
                run(options.physpring, 'train', recording, '-o', twin, '--seed', 1)
            fit, later = errors(options.physpring, twin, recording, truth, folder)
            print(f'| {name}, {recording.stem} | {fit:.1f} | {later:.1f} |', flush=True)


if __name__ == '__main__':
    main()
