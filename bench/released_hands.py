#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Spring networks that a hand lets go and takes hold of elsewhere: does a fit predict that?

For each body it writes NAME_fit.npz and NAME_other.npz, two motions of one body in the simulator of
clean_networks.py. Two hands hold it. The second one opens after a second and takes hold at another
place, nearer to the middle, after two. Its springs there begin with the lengths of that moment, as
`physpring` takes them. NAME_true.twin.npz is the body itself. `physpring train NAME_fit.npz` and `eval` of
the twin on NAME_other.npz give the errors; `eval` of the true twin gives those that noise alone makes.
"""
import argparse
import pathlib

import clean_networks
import numpy as np
import scipy.spatial
from clean_networks import NoEffect

OPENS, CLOSES = 1.0, 2.0  # s
PLACE = 0.7  # of the way from the first hand to the second one, by the order of points between them
BESIDE = 0.008 * np.array([0.6, 0, 0.8])  # m, of a controller from the point that it holds


class OpenHand(NoEffect):
    """Hand 1 holds before OPENS; hand 2, which is the same one elsewhere, from CLOSES on."""

    def __init__(self, held_again):
        self.held_again = held_again  # the points

    def start(self, system):
        self.system, self.longer = system, None
        first = np.concatenate([system["points"], system["controllers"]])
        hand = np.full(len(first), -1)
        hand[len(system["points"]):] = system["owner"]
        self.hand = hand[system["springs"]].max(axis=1)

    def tension(self, time, step, length, stretch, rate):
        k, c = self.system["stiffness"], self.system["dashpot"]
        holds = (self.hand != 1) | (time < OPENS)
        holds &= (self.hand != 2) | (time >= CLOSES)
        if self.longer is None and time >= CLOSES:
            self.longer = np.where(self.hand == 2, stretch, 0)  # than at the start
        extra = np.where(holds, 0, -(k * stretch + c * rate))
        return extra if self.longer is None else extra - k * self.longer

    def force(self, time, x, v):
        if time < CLOSES:  # the hand waits beside the points that it will hold
            self.system["controllers"][self.system["owner"] == 2] = x[self.held_again] + BESIDE
        return 0


def with_another_grasp(system):
    """The system with a third hand, and the points that it holds."""
    points, hands = system["points"], system["controllers"]
    ends = [hands[system["owner"] == hand].mean(axis=0) for hand in (0, 1)]
    along = (points - ends[0]) @ (ends[1] - ends[0]) / np.sum((ends[1] - ends[0]) ** 2)
    held = np.argsort(np.abs(along - PLACE))[:3]
    nearest = scipy.spatial.cKDTree(points).query(points[held] + BESIDE, 4)[1]
    springs = np.array([(n, len(points) + len(hands) + c) for c, row in enumerate(nearest)
                        for n in row], np.int32)
    length = np.linalg.norm(points[springs[:, 0]] -
                            (points[held] + BESIDE)[springs[:, 1] - len(points) - len(hands)], axis=1)
    stiffness = np.median(system["stiffness"] * system["length"]) / length
    loss_time = np.median(system["dashpot"] / system["stiffness"])
    joined = {"controllers": points[held] + BESIDE, "owner": np.full(3, 2), "springs": springs,
              "length": length, "stiffness": stiffness, "dashpot": loss_time * stiffness}
    return {**system, **{name: np.concatenate([system[name], more])
                         for name, more in joined.items()}}, held


def write_true_twin(path, body, system):
    both, _ = with_another_grasp(system)
    clean_networks.write_true_twin(path, body, both)
    with np.load(path) as arrays:
        np.savez(path, **arrays, late=(both["owner"] == 2).astype(np.int32))


def write_motion(path, body, system, seeds, amplitude, random):
    paths = [lambda time, seed=seed: clean_networks.hand_path(
        time, np.random.default_rng(seed), amplitude) for seed in seeds]
    late = lambda time: paths[1](time) - paths[1](np.array([CLOSES]))  # noqa: E731
    both, held = with_another_grasp(system)
    points, controllers = clean_networks.simulate(both, body.fps, [*paths, late], OpenHand(held))
    owner, time = both["owner"], np.arange(len(points)) / body.fps
    hands = controllers[:, owner < 2]
    again = np.flatnonzero(time >= CLOSES)
    hands[np.ix_(again, np.flatnonzero(owner == 1))] = controllers[np.ix_(again,
                                                                          np.flatnonzero(owner == 2))]
    holds = np.ones(hands.shape[:2], bool)
    holds[np.ix_((time > OPENS) & (time < CLOSES), np.flatnonzero(owner[owner < 2] == 1))] = False
    clean_networks.write_recording(path, body, points, hands, random)
    with np.load(path) as arrays:
        np.savez(path, **arrays, held=holds, train_frames=int(0.8 * len(points)))
    return points


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=pathlib.Path, help="folder")
    parser.add_argument("--only", nargs="*", default=["rope", "ribbon"], help="names of bodies")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--amplitude", type=float, default=0.006, help="of the hands, m")
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    for number, (name, body) in enumerate(
            clean_networks.bodies(np.random.default_rng(args.seed)).items()):
        if name not in args.only:
            continue
        random = np.random.default_rng([args.seed, number])
        system = clean_networks.system_of(body, random)
        write_true_twin(args.output / f"{name}_true.twin.npz", body, system)
        for motion in ("fit", "other"):
            points = write_motion(args.output / f"{name}_{motion}.npz", body, system,
                                  random.integers(1 << 30, size=2), args.amplitude, random)
            travel = np.linalg.norm(points - points[0], axis=2).mean()
            print(f"{name}_{motion}: {1e3 * travel:.0f} mm from the start", flush=True)


if __name__ == "__main__":
    main()
