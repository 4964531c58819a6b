#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do the 90 % intervals of a twin's material hold the true one in 90 % of the cases?

Makes spring networks of known truth, each of another shape, stiffness, loss time, drag, frame rate,
noise and motion, trains a twin of each, and counts how often the intervals hold the true stiffness
of each class of springs, the loss time and the drag. The simulator is that of clean_networks.py. A
class is left out if the true body does not have all of its springs. What was made before is not made
again.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess

import numpy as np

import clean_networks
from clean_networks import (Body, bowed, corner, end, grid, open_bag, ring, scatter, simulate,
                            system_of, upright, write_recording)

def log_uniform(random, low, high):
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def shapes(random):
    """Functions that make the points of a body, its grasps, and the reach of its springs."""
    left, right = end(0, -1, 0.012), end(0, 1, 0.012)
    spacing = random.uniform(0.016, 0.03)
    reach = spacing * random.choice([1.55, 2.1, 2.3])

    def rope():
        return grid((random.integers(16, 26), 2, 2), spacing), [left, right], reach

    def hanging_rope():
        return grid((random.integers(14, 22), 2, 2), spacing), [left], reach

    def ribbon():
        return bowed(grid((random.integers(14, 22), 4, 1), spacing)), [left, right], reach

    def cloth():
        jitter = random.choice([0, 0.15]) * spacing
        points = upright(bowed(grid((8, 9, 1), spacing, jitter, random)))
        return points, [corner(-1, 1, 0.03, other=2), corner(1, 1, 0.03, other=2)], reach

    def bag():
        return open_bag(3 * spacing, 14, 5, spacing), [end(2, 1, 0.006)], reach

    def block():
        return grid((6, 4, 3), spacing), [end(0, -1, 0.006)], reach

    def hoop():
        return upright(bowed(ring(4 * spacing, 26, 3, spacing), 3)), [end(2, 1, 0.012)], reach

    def cushion():
        half = np.array([4, 2.4, 1.4]) * spacing
        points = scatter(lambda p: np.sum((p / half) ** 2) < 1, half, 70, 0.8 * spacing, random)
        return points, [left, right], 2.1 * spacing

    return [rope, hanging_rope, ribbon, cloth, bag, block, hoop, cushion]


def make_body(folder, seed):
    random = np.random.default_rng(seed)
    made = shapes(random)
    points, grasps, reach = made[seed % len(made)]()
    body = Body(points, grasps, reach, log_uniform(random, 1.5, 8), int(random.choice([30, 50, 60])),
                log_uniform(random, 6e-4, 4e-3), log_uniform(random, 0.04, 0.15))
    system = system_of(body, random)
    length = system["length"]
    nodes = len(points)
    between = (system["springs"] < nodes).all(axis=1)
    # stiffness by class of length, and half of the bodies are softer at one end than at the other
    bins = np.linspace(length[between].min(), 1.001 * length[between].max(), 5)
    by_class = np.exp(random.normal(0, 0.5, 6))[np.digitize(length, bins)]
    axis = points[:, 0] - points[:, 0].mean()
    tilt = random.choice([0, random.uniform(0.3, 0.8)])
    middle = np.append(axis, np.zeros(len(system["controllers"])))[system["springs"]].mean(axis=1)
    system["stiffness"] *= np.where(between, by_class * np.exp(tilt * middle / abs(axis).max()), 1)
    # no stiffer than training's 10,000 sub-steps a second allow, with its safety
    step = 1e-4 / 0.7
    laplacian = np.zeros((nodes, nodes))
    for (a, b), k in zip(system["springs"], system["stiffness"]):
        for i, j in ((a, b), (b, a)):
            if i < nodes:
                laplacian[i, i] += k
                if j < nodes:
                    laplacian[i, j] -= k
    fastest = np.linalg.eigvalsh(laplacian).max() / system["mass"][0]
    allowed = 0.8 * 4 / (step ** 2 + 2 * step * body.loss_time)
    system["stiffness"] *= min(1, allowed / fastest)
    system["dashpot"] = body.loss_time * system["stiffness"]
    clean_networks.DRAG = log_uniform(random, 0.5, 4)
    clean_networks.NOISE = log_uniform(random, 3e-4, 1.5e-3)
    path_seeds = random.integers(1 << 30, size=len(grasps))
    amplitude = random.uniform(0.004, 0.01)
    paths = [lambda time, s=s: clean_networks.hand_path(time, np.random.default_rng(s), amplitude)
             for s in path_seeds]
    frames, controllers = simulate(system, body.fps, paths)
    name = folder / f"body_{seed}"
    write_recording(f"{name}.npz", body, frames, controllers, random)
    np.savez(f"{name}.truth.npz", springs=system["springs"], loss_time=body.loss_time,
             drag=clean_networks.DRAG, axial_stiffness=system["stiffness"] * length)
    return f"{made[seed % len(made)].__name__}, {nodes} points, {len(length)} springs, {body.fps} fps"


def make_and_train(folder, seed, program):
    name = folder / f"body_{seed}"
    if not name.with_suffix(".truth.npz").exists():
        make_body(folder, seed)
    done = subprocess.run([program, "train", f"{name}.npz", "-o", f"{name}.twin.npz", "--threads", "1",
                           "--resume"], capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stderr.strip()


def quantities(folder, seed):
    """(what, true value, (value, low, high)) of each quantity that the twin gives an interval of."""
    twin = np.load(folder / f"body_{seed}.twin.npz")
    truth = np.load(folder / f"body_{seed}.truth.npz")
    springs, nodes = twin["level0/springs"], len(twin["level0/mass"])
    length = twin["level0/rest_length"]
    true = {tuple(sorted(pair)): value
            for pair, value in zip(truth["springs"].tolist(), truth["axial_stiffness"])}
    between = (springs < nodes).all(axis=1)
    material = json.loads(twin["meta"].tobytes())["material"]
    found = []
    for one in material["classes"]:
        of_class = between & (length > one["shortest_m"] - 1e-9) & (length < one["longest_m"] + 1e-9)
        values = [true.get(tuple(sorted(pair))) for pair in springs[of_class].tolist()]
        if None not in values:
            found.append(("stiffness", np.mean(values), one["axial_stiffness_n"]))
    found.append(("loss time", float(truth["loss_time"]), material["loss_time_s"]))
    found.append(("drag", float(truth["drag"]), material["drag_1_s"]))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--program", default="physpring")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, help="seed of the first body")
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    args.folder.mkdir(parents=True, exist_ok=True)
    seeds = range(args.first, args.first + args.count)
    with concurrent.futures.ProcessPoolExecutor(args.jobs) as pool:
        made = {s: pool.submit(make_and_train, args.folder, s, args.program) for s in seeds}
    held, widths = {}, []
    for seed in seeds:
        if made[seed].result():
            print(f"body {seed}: {made[seed].result()}")
            continue
        line = []
        for what, true, (value, low, high) in quantities(args.folder, seed):
            held.setdefault(what, []).append(low <= true <= high)
            widths.append(high / value)
            line.append(f"{what} {value / true:.2f} (to {high / value:.2f})"
                        f"{'' if held[what][-1] else ' MISSED'}")
        print(f"body {seed}: " + ", ".join(line))
    everything = sum(held.values(), [])
    for what, of_kind in [*held.items(), ("all", everything)]:
        print(f"{what}: {sum(of_kind)} of {len(of_kind)} within 90 % ({np.mean(of_kind):.0%})")
    print(f"upper bounds: half are below {np.median(widths):.2f} times the value, nine tenths below "
          f"{np.quantile(widths, 0.9):.1f} times")


if __name__ == "__main__":
    main()
