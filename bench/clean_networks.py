#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Clean spring networks of known truth: does a fit predict an unseen motion, and find the material?

For each body of BODIES it writes NAME_fit.npz and NAME_other.npz, two motions of the same body, and
NAME_true.twin.npz, the body itself. The simulator is symplectic Euler of ten lines, independent of
PhySPRING's. The measurements get 0.7 mm of noise an axis, and 3 % of the points are unseen.
`physpring eval NAME_true.twin.npz NAME_other.npz` gives the error that noise alone makes: 1.12 mm.
Bodies whose true twin has more are chaotic, and judge no fit.
"""

import argparse
import copy
import json
import pathlib

import numpy as np
import scipy.sparse
import scipy.spatial

NOISE, UNSEEN = 7e-4, 0.03  # m an axis, share
STEP = 1e-4  # s
SECONDS = 3
GRAVITY = np.array([0, 0, -9.81])
DRAG = 2.0  # 1/s


class Body:
    """Points, what holds them, and how stiff and lossy they are."""

    def __init__(self, points, grasps, reach, stiffness, fps, loss_time=1.5e-3, mass=0.08):
        self.points = points - points.mean(axis=0) + [0, 0, 0.5]
        self.grasps = grasps  # each a function of the points that marks those it holds
        self.reach = reach  # springs join points nearer than this, m
        self.stiffness = stiffness  # stiffness times length of a spring, N
        self.fps, self.loss_time, self.mass = fps, loss_time, mass
        self.field = None  # of where along x from -1 to 1: the logarithm of a factor of stiffness

    def with_field(self, field):
        body = copy.copy(self)
        body.field = field
        return body


def grid(counts, spacing, jitter=0, random=None):
    axes = [np.arange(n) * spacing for n in counts]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if jitter:
        points = points + random.uniform(-jitter, jitter, points.shape) * (np.array(counts) > 1)
    return points


def scatter(inside, box, count, apart, random):
    """`count` points within `box` where `inside` holds, none nearer than `apart`."""
    points = np.empty((0, 3))
    while len(points) < count:
        point = random.uniform(-1, 1, 3) * box
        if inside(point) and not (np.sum((points - point) ** 2, axis=1) < apart ** 2).any():
            points = np.vstack([points, point])
    return points


def ring(radius, around, across, spacing):
    angle = 2 * np.pi * np.arange(around) / around
    rows = [np.stack([(radius + r * spacing) * np.cos(angle), (radius + r * spacing) * np.sin(angle),
                      0 * angle], axis=1) for r in range(across)]
    return np.concatenate(rows)


def open_bag(radius, around, high, spacing):
    angle = 2 * np.pi * np.arange(around) / around
    rows = [np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle + r * spacing],
                     axis=1) for r in range(high)]
    return np.concatenate(rows)


def end(axis, side, width):
    """Marks the points within `width` of the body's end on this side (-1 or 1) of an axis."""
    def marks(points):
        along = side * points[:, axis]
        return along > along.max() - width
    return marks


def upright(points):
    """A body in the plane of x and y, turned so that y points up: it hangs."""
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


def bowed(points, by=1.5):
    """A flat body bent a little: a straight one would buckle to a side that rounding chooses."""
    along = points[:, 0] - points[:, 0].mean()
    return points - np.outer(by * along ** 2, [0, 0, 1])


def corner(x_side, other_side, width, other=1):
    """Marks the points within `width` of a corner of the body in the plane of x and another axis."""
    def marks(points):
        plane = points[:, [0, other]] * [x_side, other_side]
        return np.linalg.norm(plane - plane.max(axis=0), axis=1) < width
    return marks


def tapered(along):
    """Twice as stiff as the mean at one end, half as stiff at the other."""
    return 0.7 * along


def soft_in_the_middle(along):
    return -0.8 * np.exp(-(along / 0.3) ** 2)


def bodies(random):
    jittered = upright(bowed(grid((9, 9, 1), 0.03, 0.008, random)))
    tee = [p for p in grid((11, 11, 1), 0.025, 0.004, random)
           if p[1] > 0.19 or abs(p[0] - 0.125) < 0.04]
    disc = scatter(lambda p: np.hypot(p[0], p[1]) < 0.13, [0.13, 0.13, 0.004], 90, 0.018, random)
    capsule = scatter(lambda p: np.hypot(np.hypot(p[1], p[2]), max(0, abs(p[0]) - 0.12)) < 0.035,
                      [0.16, 0.035, 0.035], 90, 0.016, random)
    triangles = grid((8, 9, 1), 0.03)
    triangles[:, 0] += 0.015 * (np.round(triangles[:, 1] / 0.03) % 2)
    triangles[:, 1] *= np.sqrt(0.75)
    left, right = end(0, -1, 0.012), end(0, 1, 0.012)
    uniform = {
        "rope": Body(grid((26, 2, 2), 0.02), [left, right], 0.0425, 5, 50),
        "whip": Body(grid((32, 1, 1), 0.015), [left], 0.032, 6, 60),
        "ribbon": Body(grid((24, 3, 2), 0.018), [left, right], 0.038, 3, 30),
        "sheet": Body(jittered, [corner(-1, 1, 0.04, other=2), corner(1, 1, 0.04, other=2)],
                      0.066, 3, 30),
        "tee": Body(upright(bowed(np.array(tee))), [end(2, 1, 0.012)], 0.055, 3, 50),
        "triangles": Body(bowed(triangles), [corner(-1, 1, 0.035), corner(1, 1, 0.035)],
                          0.062, 3, 60),
        "ring": Body(upright(bowed(ring(0.09, 28, 3, 0.02), 3)), [end(2, 1, 0.012)], 0.055, 4, 50),
        "disc": Body(bowed(disc), [left, right], 0.055, 3, 30),
        "capsule": Body(capsule, [left, right], 0.05, 2.5, 60),
        "bag": Body(open_bag(0.07, 18, 6, 0.025), [end(2, 1, 0.006)], 0.06, 4, 50),
        "block": Body(grid((7, 4, 4), 0.025), [end(0, -1, 0.006)], 0.045, 3, 50),
    }
    return uniform | {
        "tapered_rope": uniform["rope"].with_field(tapered),
        "tapered_sheet": uniform["sheet"].with_field(tapered),
        "soft_ribbon": uniform["ribbon"].with_field(soft_in_the_middle),
    }


def springs_within(points, reach):
    tree = scipy.spatial.cKDTree(points)
    return tree.query_pairs(reach, output_type="ndarray").astype(np.int32)


def system_of(body, random):
    """The body with its controllers as arrays. A hand's controllers are 8 mm beside three of the
    points that it holds, and each is joined to the four points nearest to it."""
    points, hands, ends = body.points, [], [np.sort(springs_within(body.points, body.reach), axis=1)]
    for marks in body.grasps:
        held = np.flatnonzero(marks(points))
        chosen = held[np.linspace(0, len(held) - 1, min(3, len(held))).round().astype(int)]
        hands.append(points[chosen] + 0.008 * np.array([0.6, 0, 0.8]))
    controllers = np.concatenate(hands)
    owner = np.concatenate([[h] * len(hand) for h, hand in enumerate(hands)])
    nearest = scipy.spatial.cKDTree(points).query(controllers, 4)[1]
    ends.append(np.array([(n, len(points) + c) for c, row in enumerate(nearest) for n in row]))
    springs = np.concatenate(ends).astype(np.int32)
    everything = np.concatenate([points, controllers])
    length = np.linalg.norm(everything[springs[:, 0]] - everything[springs[:, 1]], axis=1)
    stiffness = body.stiffness / length
    if body.field:
        x = points[:, 0]
        of_points = (springs < len(points)).all(axis=1)
        middle = everything[springs[of_points]].mean(axis=1)[:, 0]
        stiffness[of_points] *= np.exp(body.field(2 * (middle - x.min()) / np.ptp(x) - 1))
    return dict(points=points, controllers=controllers, owner=owner, springs=springs,
                length=length, stiffness=stiffness, dashpot=body.loss_time * stiffness,
                mass=np.full(len(points), body.mass / len(points)))


def hand_path(time, random, amplitude):
    """A smooth path from rest: three sines an axis, m."""
    ramp = 1 - np.exp(-(time / 0.3) ** 2)
    path = np.zeros((len(time), 3))
    for axis in range(3):
        for _ in range(3):
            frequency, phase = random.uniform(0.4, 1.6), random.uniform(0, 2 * np.pi)
            path[:, axis] += random.uniform(0.2, 1) * (
                np.sin(2 * np.pi * frequency * time + phase) - np.sin(phase))
    return amplitude * ramp[:, None] * path


class NoEffect:
    """What a network does besides springs, gravity and linear drag: nothing. Subclasses add to it."""

    delay = 0.0  # how much later the hands move than the recording says, s

    def start(self, system):
        """Before the first step, with the arrays of system_of."""

    def tension(self, time, step, length, stretch, rate):
        """Tension of each spring besides k stretch + c rate, N."""
        return 0

    def force(self, time, x, v):
        """Forces on the points, (N, 3) N."""
        return 0


def simulate(system, fps, paths, effect=NoEffect()):
    """Positions in each frame and the controllers' (T, N, 3), (T, C, 3)."""
    n, springs = len(system["points"]), system["springs"]
    rows = np.arange(len(springs))
    ends = scipy.sparse.csr_matrix(
        (np.repeat([1.0, -1.0], len(springs)), (np.tile(rows, 2), springs.T.ravel())),
        shape=(len(springs), n + len(system["controllers"])))
    on_nodes = ends[:, :n].T.tocsr()
    effect.start(system)
    x, v = system["points"].copy(), np.zeros((n, 3))
    frames = int(SECONDS * fps)
    substeps = int(round(1 / fps / STEP))
    step = 1 / fps / substeps
    times = np.arange(frames * substeps + 1) * step

    def hands_at(times):
        return np.stack([path(times) for path in paths])[system["owner"]]  # (C, steps, 3)

    recorded, hands = hands_at(times), hands_at(np.maximum(times - effect.delay, 0))
    k, c, rest = system["stiffness"], system["dashpot"], system["length"]
    points, controllers = [], []
    for i in range((frames - 1) * substeps + 1):
        if i % substeps == 0:
            points.append(x.copy())
            controllers.append(system["controllers"] + recorded[:, i])
        hand = system["controllers"] + hands[:, i]
        # MuJoCo's mocap bodies, and these hands, have no velocity
        d = ends @ np.concatenate([x, hand])
        length = np.linalg.norm(d, axis=1)
        u = d / length[:, None]
        rate = np.einsum("ij,ij->i", ends @ np.concatenate([v, 0 * hand]), u)
        tension = k * (length - rest) + c * rate
        tension = tension + effect.tension(times[i], step, length, length - rest, rate)
        force = on_nodes @ (-tension[:, None] * u) + effect.force(times[i], x, v)
        v = (v + step * (force / system["mass"][:, None] + GRAVITY)) * np.exp(-DRAG * step)
        x = x + step * v
    return np.array(points), np.array(controllers)


def write_true_twin(path, body, system):
    nodes = len(system["points"])
    meta = {"format": "physpring twin", "version": 1, "program": "clean_networks", "name": path.stem,
            "levels": 1, "points": nodes, "interior": 0,
            "controllers": len(system["controllers"]), "controller_velocity": False,
            "recordings": [], "seed": 0, "options": {}}
    level = {
        "position": np.concatenate([system["points"], system["controllers"]]),
        "mass": system["mass"], "springs": system["springs"], "stiffness": system["stiffness"],
        "rest_length": system["length"], "dashpot": system["dashpot"], "drag": DRAG,
        "contact_radius": np.zeros(nodes), "restitution": 0.5, "friction": 0.3,
        "object_restitution": 0.7, "object_friction": 0.3, "collision_distance": 0.0,
        "substeps_per_second": np.int32(1 / STEP)}
    np.savez(path, meta=np.frombuffer(json.dumps(meta).encode(), np.uint8), fps=float(body.fps),
             gravity=GRAVITY, **{"level0/" + name: np.asarray(v) for name, v in level.items()})


def write_recording(path, body, points, controllers, random):
    measured = points + random.normal(0, NOISE, points.shape)
    measured[random.random(points.shape[:2]) < UNSEEN] = np.nan
    measured[0] = points[0]
    np.savez(path, points=measured, controllers=controllers, fps=float(body.fps), mass=body.mass,
             gravity=GRAVITY)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=pathlib.Path, help="folder")
    parser.add_argument("--only", nargs="*", help="names of bodies")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--amplitude", type=float, default=0.006, help="of the hands, m")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    for number, (name, body) in enumerate(bodies(np.random.default_rng(args.seed)).items()):
        if args.only and name not in args.only:
            continue
        random = np.random.default_rng([args.seed, number])
        system = system_of(body, random)
        write_true_twin(args.output / f"{name}_true.twin.npz", body, system)
        for motion in ("fit", "other"):
            paths = []
            for _ in body.grasps:
                seed = random.integers(1 << 30)
                paths.append(lambda time, seed=seed: hand_path(
                    time, np.random.default_rng(seed), args.amplitude))
            points, controllers = simulate(system, body.fps, paths)
            travel = np.linalg.norm(points - points[0], axis=2).mean()
            write_recording(args.output / f"{name}_{motion}.npz", body, points, controllers, random)
            print(f"{name}_{motion}: {len(system['points'])} points, {len(system['springs'])} "
                  f"springs, {len(points)} frames, {1e3 * travel:.0f} mm from the start", flush=True)


if __name__ == "__main__":
    main()
