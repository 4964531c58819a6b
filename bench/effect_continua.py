#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Finite-element bodies that are recorded clean, and then again with something changed.

A twin is trained on BODY_clean.npz. Then something changes that no recording tells of: a mass, the
wind, the hand's delay. BODY_EFFECT.npz is another motion after that, and key.json says what changed.
Of each body one recording is of another motion alone. `physpring record` simulates all of them, so
the mechanics are MuJoCo's. An effect is made stronger or weaker until it moves the body by 8 to
40 mm in the mean.
"""

import argparse
import json
import pathlib
import subprocess

import numpy as np

LEAST, MOST = 0.008, 0.04  # m by which an effect moves the body in the mean
RATE = "--fps", "40"


def grid(count, spacing, middle):
    """The vertices of a flexcomp grid, (n,3) in m, in MuJoCo's order."""
    axes = [(np.arange(n) - (n - 1) / 2) * spacing for n in count]
    return np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3) + middle


class Body:
    """A flexcomp, and which of its vertices each hand holds: lists of numbers."""

    def __init__(self, count, spacing, height, mass, elasticity, hands):
        self.count, self.mass, self.elasticity = count, mass, elasticity
        self.points = grid(count, spacing, [0, 0, height])
        self.spacing, self.height, self.hands = spacing, height, [np.flatnonzero(h(self.points))
                                                                  for h in hands]

    def scene(self, random):
        places = [self.points[hand].mean(axis=0) for hand in self.hands]
        hands = "".join(f'<body name="hand{i}" mocap="true" pos="{text(place)}"/>'
                        for i, place in enumerate(places))
        ties = "".join(f'<connect body1="body_{vertex}" body2="hand{i}" anchor="0 0 0"/>'
                       for i, hand in enumerate(self.hands) for vertex in hand)
        keys, lift = "", 0.12 if self.height < 0.1 else 0.0
        for time in np.arange(0, 3, 0.5):
            moved = [place + (time > 0) * (random.normal(size=3) * [0.03, 0.03, 0.02] + [0, 0, lift])
                     for place in places]
            keys += f'<key time="{time}" mpos="{" ".join(text(place) for place in moved)}"/>'
        dim = 2 if self.count[2] == 1 else 3
        return f"""<mujoco model="body">
<option timestep="0.002" integrator="discrete" solver="CG" iterations="500"/>
<default><equality solref="0.004 1" solimp="0.99 0.999 0.001"/></default>
<worldbody><geom name="floor" type="plane" size="2 2 0.1"/>{hands}
<flexcomp name="body" type="grid" dim="{dim}" count="{text(self.count)}" radius="0.003"
 spacing="{text([self.spacing] * 3)}" pos="0 0 {self.height}" mass="{self.mass}">
<elasticity {self.elasticity}/><contact selfcollide="none" friction="0.4" solref="0.005 1"/>
</flexcomp></worldbody><equality>{ties}</equality><keyframe>{keys}</keyframe></mujoco>"""


def text(numbers):
    return " ".join(f"{number:g}" for number in numbers)


def at_end(axis, sign, depth):
    return lambda p: sign * p[:, axis] > (sign * p[:, axis]).max() - depth


def both(one, other):
    return lambda p: one(p) & other(p)


def bodies(random):
    def about(value):
        return value * random.uniform(0.8, 1.25)

    solid = 'poisson="0.25" damping="0.006"'
    sheet = 'poisson="0.2" thickness="0.002" damping="0.004" elastic2d="both"'
    left, right = at_end(0, -1, 0.02), at_end(0, 1, 0.02)
    return {
        "rope": Body((22, 2, 2), 0.016, 0.4, 0.06, f'young="{about(2e5):g}" {solid}', [left]),
        "bridge": Body((24, 2, 2), 0.016, 0.3, 0.08, f'young="{about(1.5e4):g}" {solid}',
                       [left, right]),
        "cloth": Body((11, 9, 1), 0.024, 0.4, 0.04, f'young="{about(1.5e5):g}" {sheet}',
                      [both(left, at_end(1, -1, 0.03)), both(right, at_end(1, -1, 0.03))]),
        "towel": Body((13, 7, 1), 0.024, 0.012, 0.05, f'young="{about(1e5):g}" {sheet}', [left]),
        "block": Body((9, 6, 4), 0.02, 0.3, 0.2, f'young="{about(8e3):g}" {solid}', [left]),
        "pillow": Body((8, 7, 3), 0.022, 0.026, 0.15, f'young="{about(1e4):g}" {solid}',
                       [both(left, at_end(2, 1, 0.01)), both(right, at_end(2, 1, 0.01))]),
    }


def mass(random, strength, body):
    return {"mass_distribution.mass_kg": 0.2 * strength * body.mass}


def wind(random, strength, body):
    way = random.normal(size=2)
    way *= 3 / np.linalg.norm(way)
    return {"air_drag.drag_kg_per_m": 0.02 * strength * body.mass / 0.05,
            "air_drag.wind_x_m_per_s": way[0], "air_drag.wind_y_m_per_s": way[1]}


def tilt(random, strength, body):
    way = random.uniform(0, 2 * np.pi)
    tilt = min(0.12 * strength, 0.5)
    return {"gravity_direction.tilt_x_rad": tilt * np.cos(way),
            "gravity_direction.tilt_y_rad": tilt * np.sin(way)}


def late(random, strength, body):
    return {"control_latency.latency_s": min(0.05 * strength, 0.2)}


def tether(random, strength, body):
    return {"tether.stiffness_n_per_m": 40 * strength * body.mass}


def floor(random, strength, body):
    return {"ground_contact.friction_change": 0.5 * strength}


CHANGES = {"rope": [mass, late], "bridge": [mass, tilt], "cloth": [wind, tether],
           "towel": [floor, wind], "block": [tilt, tether], "pillow": [late, mass]}


class Recorder:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def record(self, scene, name, values, *options):
        path = self.folder / f"{name}.xml"
        path.write_text(scene)
        effects = [f"--effect={key}={value}" for key, value in values.items()]
        command = [self.program, "record", path, "-o", self.folder / f"{name}.npz", "--force",
                   *RATE, *options, *effects]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        return np.load(self.folder / f"{name}.npz")["points"]


def strong_enough(recorder, scene, body, change, seed):
    """The values of the effect, and the m by which it moves the body."""
    clean = recorder.record(scene, "probe", {})
    strength = 1.0
    for _ in range(8):
        values = change(np.random.default_rng(seed), strength, body)
        moved = recorder.record(scene, "probe", values)
        by = float(np.linalg.norm(moved - clean, axis=2).mean())
        if LEAST <= by <= MOST:
            break
        strength *= 2 if by < LEAST else 0.6
    return values, by


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", help="physpring")
    parser.add_argument("output", type=pathlib.Path, help="folder")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    recorder, key = Recorder(args.program, args.output), {}
    random = np.random.default_rng(args.seed)
    for name, body in bodies(random).items():
        seeds = iter(range(args.seed, args.seed + 100))

        def noisy():
            return "--noise", "0.0007", "--occlusion", "0.03", "--seed", str(next(seeds))

        recorder.record(body.scene(random), f"{name}_clean", {}, *noisy())
        recorder.record(body.scene(random), f"{name}_none", {}, *noisy())
        key[f"{name}_none"] = {"effect": "none"}
        for change in CHANGES[name]:
            scene = body.scene(random)
            values, by = strong_enough(recorder, scene, body, change, random.integers(1 << 30))
            effect = next(iter(values)).split(".")[0]
            recorder.record(scene, f"{name}_{effect}", values, *noisy())
            key[f"{name}_{effect}"] = {"effect": effect, "truth": values,
                                       "mean_displacement_due_to_effect_m": by}
            print(name, values, by, flush=True)
    (args.output / "key.json").write_text(json.dumps(key, indent=1, default=float) + "\n")


if __name__ == "__main__":
    main()
