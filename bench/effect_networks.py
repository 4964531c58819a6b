#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Spring networks that lack something: does a diagnosis name it?

For each case it writes CASE_train.npz and CASE_eval.npz, two motions of one body that has an effect
which the recordings do not tell of, and a line of key.json that does. Of four cases one has none.
The simulator is that of clean_networks.py, so neither PhySPRING's nor MuJoCo's. An effect is made
stronger or weaker until it moves the body by 8 to 40 mm in the mean.
"""

import argparse
import json
import pathlib

import numpy as np

import clean_networks
from clean_networks import Body, NoEffect, bowed, corner, end, grid, scatter, upright

LEAST, MOST = 0.008, 0.04  # m by which an effect moves the body in the mean


def bodies(random):
    left, right = end(0, -1, 0.012), end(0, 1, 0.012)
    ell = [p for p in grid((9, 9, 2), 0.024) if p[0] < 0.06 or p[1] < 0.06]
    cross = [p for p in grid((11, 11, 1), 0.026, 0.003, random)
             if min(abs(p[0] - 0.13), abs(p[1] - 0.13)) < 0.04]
    wedge = scatter(lambda p: abs(p[1]) < 0.05 * (0.5 - p[2] / 0.08), [0.12, 0.05, 0.04], 80, 0.019,
                    random)
    angle, radius = np.meshgrid(np.linspace(0, np.pi / 2, 10), np.arange(0.07, 0.2, 0.021))
    fan = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], -1).reshape(-1, 3)
    along, around = np.meshgrid(np.arange(12) * 0.025, 2 * np.pi * np.arange(8) / 8)
    tube = np.stack([along, 0.035 * np.cos(around), 0.035 * np.sin(around)], -1).reshape(-1, 3)
    ladder = [p for p in grid((19, 5, 1), 0.018) if p[1] in (0, 0.072) or round(p[0] / 0.018) % 3 == 0]
    saddle = grid((9, 9, 1), 0.028, 0.004, random)
    middle = saddle - saddle.mean(axis=0)
    saddle[:, 2] += 3 * (middle[:, 0] ** 2 - middle[:, 1] ** 2)
    return {
        "ell": Body(upright(np.array(ell)), [end(0, -1, 0.03)], 0.045, 4, 50),
        "cross": Body(upright(bowed(np.array(cross))), [end(2, 1, 0.02)], 0.058, 3, 40),
        "wedge": Body(wedge, [left, right], 0.055, 3, 60),
        "fan": Body(bowed(fan), [corner(1, -1, 0.04), corner(-1, 1, 0.04)], 0.052, 3, 30),
        "tube": Body(tube, [left, right], 0.06, 3, 50),
        "ladder": Body(bowed(np.array(ladder)), [left, right], 0.042, 4, 60),
        "saddle": Body(saddle, [corner(-1, -1, 0.04), corner(1, 1, 0.04)], 0.064, 3, 30),
    }


class Wind(NoEffect):
    name = "air_drag"

    def __init__(self, random, strength):
        self.drag = 0.02 * strength  # kg/m of the whole body
        direction = random.normal(size=3) * [1, 1, 0.3]
        self.wind = random.uniform(1.5, 3) * direction / np.linalg.norm(direction)
        self.truth = {"drag_kg_per_m": self.drag, "wind_m_per_s": list(self.wind)}

    def force(self, time, x, v):
        u = v - self.wind
        return -self.drag / len(x) * np.linalg.norm(u, axis=1, keepdims=True) * u


def far_point(system, place):
    """One of the points that are farther from the hands than most: the number of it."""
    away = np.linalg.norm(system["points"][:, None] - system["controllers"], axis=2).min(axis=1)
    far = np.flatnonzero(away > np.median(away))
    return far[place % len(far)]


class Payload(NoEffect):
    name = "mass_distribution"

    def __init__(self, random, strength):
        self.share, self.place = 0.2 * strength, random.integers(1 << 20)

    def start(self, system):
        place = far_point(system, self.place)
        added = self.share * system["mass"].sum()
        system["mass"] = system["mass"].copy()
        system["mass"][place] += added
        self.truth = {"mass_kg": added, "place_m": system["points"][place].tolist()}


class TiltedGravity(NoEffect):
    name = "gravity_direction"

    def __init__(self, random, strength):
        tilt, way = 0.1 * strength, random.uniform(0, 2 * np.pi)
        there = 9.81 * np.array([np.sin(tilt) * np.cos(way), np.sin(tilt) * np.sin(way), -np.cos(tilt)])
        self.more = there - clean_networks.GRAVITY
        self.truth = {"tilt_rad": tilt, "way_rad": way}

    def start(self, system):
        self.mass = system["mass"][:, None]

    def force(self, time, x, v):
        return self.mass * self.more


class Tether(NoEffect):
    name = "tether"

    def __init__(self, random, strength):
        self.stiffness, self.place = 4 * strength, random.integers(1 << 20)

    def start(self, system):
        self.node = far_point(system, self.place)
        self.anchor = system["points"][self.node].copy()
        self.truth = {"stiffness_n_per_m": self.stiffness, "place_m": self.anchor.tolist()}

    def force(self, time, x, v):
        force = np.zeros_like(x)
        force[self.node] = self.stiffness * (self.anchor - x[self.node])
        return force


class LateHands(NoEffect):
    name = "control_latency"

    def __init__(self, random, strength):
        self.delay = 0.05 * strength
        self.truth = {"latency_s": self.delay}


class OfSprings(NoEffect):
    def start(self, system):
        self.k, self.rest = system["stiffness"], system["length"]
        self.state = np.zeros(len(self.rest))


class Yield(OfSprings):
    name = "yield"

    def __init__(self, random, strength):
        self.strain = 0.06 / strength
        self.truth = {"yield_strain": self.strain}

    def tension(self, time, step, length, stretch, rate):
        elastic = np.clip(stretch - self.state, -self.strain * self.rest, self.strain * self.rest)
        self.state = stretch - elastic
        return -self.k * self.state


class Friction(OfSprings):
    name = "dry_friction"

    def __init__(self, random, strength):
        self.strain = 0.02 * strength
        self.truth = {"slip_strain": self.strain}

    def tension(self, time, step, length, stretch, rate):
        self.state = np.clip(self.state + step * rate, -self.strain * self.rest,
                             self.strain * self.rest)
        return self.k * self.state


class Stiffening(OfSprings):
    name = "stiffening"

    def __init__(self, random, strength):
        self.ratio = 60 * strength
        self.truth = {"cubic_stiffness_ratio": self.ratio}

    def tension(self, time, step, length, stretch, rate):
        return self.ratio * self.k * stretch ** 3 / self.rest ** 2


class Slack(OfSprings):
    name = "tension_only"

    def __init__(self, random, strength):
        self.share = min(1, 0.6 * strength)
        self.truth = {"slack_share": self.share}

    def tension(self, time, step, length, stretch, rate):
        return self.share * self.k * np.maximum(-stretch, 0)


class Relaxation(OfSprings):
    name = "viscoelastic"

    def __init__(self, random, strength):
        self.share, self.time = min(0.8, 0.4 * strength), random.uniform(0.15, 0.5)
        self.truth = {"relaxing_share": self.share, "relaxation_time_s": self.time}

    def tension(self, time, step, length, stretch, rate):
        self.state += step * (rate - self.state / self.time)
        return self.share * self.k * (self.state - stretch)


class Push(NoEffect):
    """A periodic force on the whole body; no effect of a diagnosis' list."""
    name = "law_push"

    def __init__(self, random, strength):
        self.rate = random.uniform(3, 12)
        way = random.normal(size=3)
        self.amplitude = 1.5 * strength * way / np.linalg.norm(way)
        self.truth = {"acceleration_m_per_s2": self.amplitude.tolist(), "rate_rad_per_s": self.rate}

    def start(self, system):
        self.mass = system["mass"][:, None]

    def force(self, time, x, v):
        return self.mass * self.amplitude * np.sin(self.rate * time)


class Ageing(OfSprings):
    """Springs whose stiffness grows with the square of time."""
    name = "law_ageing"

    def __init__(self, random, strength):
        self.growth = 0.3 * strength
        self.truth = {"growth_per_s2": self.growth}

    def tension(self, time, step, length, stretch, rate):
        return self.growth * time ** 2 * self.k * stretch


class Magnet(NoEffect):
    """An attraction to a point that circles below the body."""
    name = "law_magnet"

    def __init__(self, random, strength):
        self.strength, self.rate = 0.02 * strength, random.uniform(4, 9)
        self.truth = {"strength_m3_per_s2": self.strength, "rate_rad_per_s": self.rate}

    def start(self, system):
        self.mass = system["mass"][:, None]
        self.middle = system["points"].mean(axis=0) - [0, 0, 0.1]

    def force(self, time, x, v):
        turn = self.rate * time
        d = self.middle + 0.12 * np.array([np.cos(turn), np.sin(turn), 0]) - x
        return self.strength * self.mass * d / ((d ** 2).sum(axis=1, keepdims=True) + 9e-4) ** 1.5


class Both(NoEffect):
    def __init__(self, one, other):
        self.parts, self.name = (one, other), f"{one.name} {other.name}"
        self.delay = one.delay + other.delay

    def start(self, system):
        for part in self.parts:
            part.start(system)
        self.truth = {part.name: part.truth for part in self.parts}

    def tension(self, *args):
        return sum(part.tension(*args) for part in self.parts)

    def force(self, *args):
        return sum(part.force(*args) for part in self.parts)


EFFECTS = [Wind, Payload, TiltedGravity, Tether, LateHands, Yield, Friction, Stiffening, Slack,
           Relaxation]
LAWS = [Push, Ageing, Magnet]


def strong_enough(kind, seed, clean, simulate):
    """The effect, two motions with it, and the m by which it moves the clean ones; or None."""
    if kind is None:
        return None, clean, [0.0, 0.0]

    def moved_by(motion, points):
        return float(np.linalg.norm(points - clean[motion][0], axis=2).mean())

    strength = 1.0
    for _ in range(5):
        effect = kind(np.random.default_rng(seed), strength)
        with np.errstate(all="ignore"):
            fitted = simulate(0, effect)
        by = moved_by(0, fitted[0])
        if LEAST <= by <= MOST:
            other = simulate(1, effect)
            return effect, [fitted, other], [by, moved_by(1, other[0])]
        strength *= 2 if by < LEAST else 0.6
    return None


def write_case(folder, case, body, kinds, random, amplitude):
    """Two motions of the body with the first of these effects that moves it; its line of key.json."""
    system = clean_networks.system_of(body, random)
    seeds = [[random.integers(1 << 30) for _ in body.grasps] for _ in range(2)]

    def simulate(motion, effect):
        paths = [lambda time, seed=seed: clean_networks.hand_path(
            time, np.random.default_rng(seed), amplitude) for seed in seeds[motion]]
        return clean_networks.simulate(dict(system), body.fps, paths, effect)

    clean = [simulate(motion, NoEffect()) for motion in (0, 1)]
    found = (strong_enough(kind, random.integers(1 << 30), clean, simulate) for kind in kinds)
    effect, motions, by = next(one for one in found if one is not None)
    for name, (points, controllers) in zip(("train", "eval"), motions):
        clean_networks.write_recording(folder / f"{case}_{name}.npz", body, points, controllers,
                                       random)
    return {"effect": effect.name if effect else "none", "truth": effect.truth if effect else {},
            "mean_displacement_due_to_effect_m": by}


def pair_of(random):
    one, other = random.choice(len(EFFECTS), 2, replace=False)
    return lambda random, strength: Both(EFFECTS[one](random, strength),
                                         EFFECTS[other](random, strength))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=pathlib.Path, help="folder")
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--pairs", action="store_true", help="two effects at once")
    parser.add_argument("--laws", action="store_true", help="laws that are not in the list")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--amplitude", type=float, default=0.012, help="of the hands, m")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    order = np.random.default_rng(args.seed)
    names, key = list(bodies(order)), {}
    for number in range(args.cases):
        random = np.random.default_rng([args.seed, number])
        name = names[number % len(names)]
        case = f"{number:02d}_{name}"
        kinds = [None] if number % 4 == 3 else list(order.permutation(EFFECTS))
        if args.pairs:
            kinds = [pair_of(random) for _ in range(10)]
        if args.laws:
            kinds = [LAWS[number % len(LAWS)]] * 5
        line = write_case(args.output, case, bodies(random)[name], kinds, random, args.amplitude)
        key[case] = {"object": name, **line}
        print(case, line["effect"], line["mean_displacement_due_to_effect_m"], flush=True)
    (args.output / "key.json").write_text(json.dumps(key, indent=1, default=float) + "\n")


if __name__ == "__main__":
    main()
