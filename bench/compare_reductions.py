#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains and judges all ways to reduce a twin on a set of recordings, and sets the result beside the
paper's Tables 1 to 4.

For each recording: level 0 by the full fit and by the two-stage fit, once; from the full fit's level
0, the coarser levels by each reduction and seed; and the two-stage fit of a random subset of the
particles (Table 4), which has no particles to lift to: its columns say the same. With --ablation also
learned reductions whose features do not learn, or are nothing but rest positions. Each training leaves NAME.json in the output folder; what is there is not done
again, so that a run that was stopped goes on. The page holds the tables and two plots as SVG.

  bench/compare_reductions.py REC.npz... -o results/reductions --seeds 3

Needs numpy. Means are over recordings and seeds; intervals are bootstrap intervals (95 %) over
recordings, each with all its seeds.
"""
import argparse
import html
import json
import pathlib
import subprocess
import sys
import time

import numpy as np

METHODS = {
    "learned": ["--reduction", "learned"],
    "random": ["--reduction", "random"],
    "gramian": ["--reduction", "gramian"],
    "kmeans": ["--reduction", "kmeans"],
    "learned-random-latent": ["--reduction", "learned", "--features", "untrained"],
    "position-only": ["--reduction", "learned", "--features", "positions"],
}
ABLATIONS = ("learned-random-latent", "position-only")
RATIOS = (0.6, 0.4, 0.3)
# PhySPRING, arXiv 2605.07687: mm, (CD, track) of re-simulation and of the future
PAPER = {
    ("two-stage", 0): (5.3, 9.0, 11.6, 22.0),
    ("learned", 0): (4.4, 8.0, 9.6, 19.7),
    ("learned", 1): (6.9, 11.1, 12.7, 24.4),
    ("learned", 2): (9.1, 12.7, 15.8, 28.1),
    ("learned", 3): (12.0, 16.1, 20.1, 33.7),
    ("random", 1): (11.2, 17.7, 24.6, 44.6),
    ("random", 2): (18.3, 27.5, 49.3, 81.9),
    ("random", 3): (13.3, 18.2, 20.3, 37.7),
    ("gramian", 1): (7.8, 12.4, 16.3, 30.1),
    ("gramian", 2): (9.3, 13.9, 16.5, 31.6),
    ("gramian", 3): (13.8, 18.6, 23.0, 38.5),
    ("two-stage", 1): (54.2, 60.0, 79.2, 89.5),
    ("two-stage", 2): (64.7, 87.9, 97.4, 128.1),
    ("two-stage", 3): (81.0, 107.4, 136.6, 169.0),
}
PAPER_SPEED_UP = {1: 1.65, 2: 2.00, 3: 2.30}


def run(command):
    """Runs a program; its standard output."""
    print("$", " ".join(map(str, command)), flush=True)
    done = subprocess.run([str(c) for c in command], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, check=False)
    if done.returncode != 0:
        sys.exit(f"compare_reductions: {command[0]} failed: {done.stderr.strip()}")
    return done.stdout


def train_and_judge(arguments, name, recording, judged, options):
    """Trains NAME.twin.npz, judges it on `judged`; the content of NAME.json."""
    twin = arguments.output / f"{name}.twin.npz"
    result = arguments.output / f"{name}.json"
    if name in arguments.known:
        return arguments.known[name]
    if not result.exists():
        start = time.monotonic()
        run([arguments.physpring, "train", recording, "-o", twin, "--resume", "--threads",
             arguments.threads, "--log", arguments.output / f"{name}.log", *options])
        seconds = time.monotonic() - start
        errors = arguments.output / f"{name}.errors.json"
        run([arguments.physpring, "eval", twin, judged, "--json", errors])
        report = json.loads(errors.read_text())
        judged_as = {"levels": report["levels"], "motionless": report["motionless"],
                     "train_seconds": seconds}
        temporary = result.with_suffix(".part")
        temporary.write_text(json.dumps(judged_as))
        temporary.rename(result)
        errors.unlink()
    return json.loads(result.read_text())


def write_subset(recording, ratio, seed, path):
    """The recording as seen by a random subset of its particles; all points stay what is judged."""
    arrays = dict(np.load(recording))
    points = arrays["points"]
    count = points.shape[1]
    interior = arrays["interior"].shape[0] if "interior" in arrays else 0
    controllers = arrays["controllers"].shape[1]
    kept = np.sort(np.random.default_rng(seed).permutation(count + interior)
                   [:round(ratio * (count + interior))])
    arrays.setdefault("track", points)
    arrays.setdefault("surface", points)
    arrays["points"] = points[:, kept[kept < count]]
    if interior:
        arrays["interior"] = arrays["interior"][kept[kept >= count] - count]
    of_all = np.concatenate([kept, count + interior + np.arange(controllers)])
    for name, columns in (("rest", of_all), ("order", of_all), ("velocity", kept)):
        if name in arrays:
            arrays[name] = arrays[name][columns]
    np.savez(path, **arrays)


def motionless(judged):
    """The errors of a body that stays where it starts, in the shape of a level."""
    body = {part: dict(errors) for part, errors in judged["motionless"].items()}
    for errors in body.values():
        for key in ("cd", "track"):
            errors[f"{key}_lifted"] = errors[key]
    return body


def train_all(arguments):
    """Results by (recording, method, seed): a list of levels, each with errors and speed."""
    results = {}
    for recording in arguments.recordings:
        stem = recording.stem
        full = train_and_judge(arguments, f"{stem}.full", recording, recording,
                               ["--levels", 1, *arguments.train_dense])
        results[stem, "full", 0] = full["levels"]
        results[stem, "motionless", 0] = [motionless(full)]
        two = arguments.two_stage and train_and_judge(
            arguments, f"{stem}.two-stage", recording, recording,
            ["--levels", 1, "--method", "two-stage", *arguments.train_two_stage])
        for seed in range(1, arguments.seeds + 1):
            for method in arguments.methods:
                done = train_and_judge(
                    arguments, f"{stem}.{method}.{seed}", recording, recording,
                    ["--levels", 4, *METHODS[method], "--seed", seed, "--from",
                     arguments.output / f"{stem}.full.twin.npz", *arguments.train])
                results[stem, method, seed] = done["levels"]
            if not two:
                continue
            levels = [two["levels"][0]]
            for ratio in RATIOS:
                subset = arguments.output / f"{stem}.subset{round(100 * ratio)}.{seed}.npz"
                write_subset(recording, ratio, seed, subset)
                name = f"{stem}.two-stage{round(100 * ratio)}.{seed}"
                done = train_and_judge(arguments, name, subset, subset,
                                       ["--levels", 1, "--method", "two-stage", "--seed", seed,
                                        *arguments.train_two_stage])
                levels.append(done["levels"][0])
            results[stem, "two-stage", seed] = levels
    return results


def values(results, method, level, part, key):
    """One row a recording of the value at all seeds, mm; NaN where there is none."""
    rows = {}
    for (recording, of, _), levels in results.items():
        if of == method and level < len(levels):
            value = (levels[level][part] or {}).get(key)
            rows.setdefault(recording, []).append(np.nan if value is None else 1e3 * value)
    return [np.array(row) for row in rows.values()]


def mean_and_interval(rows):
    """Mean over recordings and seeds, and the bootstrap's 2.5 and 97.5 % quantiles."""
    means = np.array([np.nanmean(row) for row in rows])
    draws = np.random.default_rng(0).integers(len(means), size=(2000, len(means)))
    return means.mean(), *np.quantile(means[draws].mean(axis=1), [0.025, 0.975])


def cell(results, method, level, part, key):
    rows = values(results, method, level, part, key)
    if not rows:
        return "-"
    mean, low, high = mean_and_interval(rows)
    return f"{mean:.2f} [{low:.2f}, {high:.2f}]"


def speed(results, method, level):
    fps = [levels[level]["fps"] / levels[0]["fps"] for (_, of, _), levels in results.items()
           if of == method and level < len(levels)]
    return f"{np.mean(fps):.2f}" if fps else "-"


def error_table(results, title, rows):
    """Errors of (method, level) rows: ours direct and lifted beside the paper's (direct)."""
    head = ["method", "level", "part", "CD", "paper", "track", "paper", "CD lifted", "track lifted"]
    body = []
    for method, level in rows:
        paper = PAPER.get((method, level))
        for k, part in enumerate(("fit", "prediction")):
            ours = [cell(results, method, level, part, key)
                    for key in ("cd", "track", "cd_lifted", "track_lifted")]
            theirs = [f"{paper[2 * k + i]:.1f}" if paper else "-" for i in (0, 1)]
            body.append([method, str(level), part, ours[0], theirs[0], ours[1], theirs[1], *ours[2:]])
    return title, head, body


def table_of_level_0(results):
    """Of each recording: the future's track error of both fits of level 0, and of no motion."""
    names = ("full", "two-stage", "motionless")
    body = []
    ratios = []
    for recording in dict.fromkeys(name for name, _, _ in results):
        one = {key: levels for key, levels in results.items() if key[0] == recording}
        errors = [values(one, name, 0, "prediction", "track") for name in names]
        means = [np.nanmean(rows[0]) if rows else np.nan for rows in errors]
        ratios.append(means[0] / means[1])
        body.append([recording, *(f"{mean:.2f}" for mean in means), f"{ratios[-1]:.2f}"])
    body.append(["mean", "", "", "", f"{np.mean(ratios):.2f}"])
    return ("Level 0: track error of the future (mm)",
            ["recording", *names, "full / two-stage"], body)


def tables(results, methods):
    coarse = (1, 2, 3)
    first = "learned" if "learned" in methods else methods[0]
    yield table_of_level_0(results)
    yield error_table(results, "Table 1: all levels (mm)",
                      [("motionless", 0), ("two-stage", 0)]
                      + [(first, level) for level in range(4)])
    head = ["level", "nodes", "springs", "speed-up", "paper", "lifted track / level 0", "paper (direct)"]
    body = []
    for level in coarse:
        some = [levels for (_, of, _), levels in results.items() if of == first]
        ratio = np.mean([levels[level]["prediction"]["track_lifted"]
                         / levels[0]["prediction"]["track_lifted"] for levels in some])
        body.append([str(level), f"{np.mean([s[level]['nodes'] for s in some]):.0f}",
                     f"{np.mean([s[level]['springs'] for s in some]):.0f}",
                     speed(results, first, level), f"{PAPER_SPEED_UP[level]:.2f}", f"{ratio:.2f}",
                     f"{PAPER['learned', level][3] / PAPER['learned', 0][3]:.2f}"])
    yield "Table 2: error against speed (prediction; each level with its own sub-step)", head, body
    yield error_table(results, "Table 3: ways to reduce (mm)",
                      [("motionless", 0), ("full", 0)]
                      + [(method, level) for level in coarse for method in methods])
    yield error_table(results, "Table 4: a two-stage fit of a random subset (mm)",
                      [(method, level) for level in coarse for method in ("two-stage", first)])


def print_table(title, head, body):
    widths = [max(len(row[i]) for row in [head, *body]) for i in range(len(head))]
    print(f"\n{title}")
    for row in [head, *body]:
        print("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip())


def plot(results, methods, x_name, x_of):
    """SVG of lifted track error (prediction) against x_of(levels, level), a line a method."""
    colours = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#7f7f7f")
    lines = {}
    for method in methods:
        some = [levels for (_, of, _), levels in results.items() if of == method]
        lines[method] = [(np.mean([x_of(s, level) for s in some]),
                          1e3 * np.mean([s[level]["prediction"]["track_lifted"] for s in some]))
                         for level in range(4)]
    points = np.array([p for line in lines.values() for p in line])
    low, high = np.array([0, 0]), points.max(axis=0) * 1.1
    place = lambda p: (60 + 400 * (p[0] - low[0]) / (high[0] - low[0]),
                       270 - 240 * (p[1] - low[1]) / (high[1] - low[1]))
    svg = ['<svg viewBox="0 0 600 320" width="600" font-family="sans-serif" font-size="12">',
           '<path d="M60 30V270H460" fill="none" stroke="#888"/>',
           f'<text x="260" y="305" text-anchor="middle">{html.escape(x_name)}</text>',
           '<text x="14" y="150" transform="rotate(-90 14 150)" text-anchor="middle">'
           'lifted track error, mm</text>']
    for part in (0, 0.5, 1):
        x, y = place(low + part * (high - low))
        svg.append(f'<text x="{x:.0f}" y="286" text-anchor="middle">{part * high[0]:.3g}</text>')
        svg.append(f'<text x="54" y="{y + 4:.0f}" text-anchor="end">{part * high[1]:.3g}</text>')
    for k, (method, line) in enumerate(lines.items()):
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in map(place, line))
        svg.append(f'<polyline points="{path}" fill="none" stroke="{colours[k % 6]}"/>')
        svg += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colours[k % 6]}"/>'
                for x, y in map(place, line)]
        svg.append(f'<text x="475" y="{50 + 18 * k}" fill="{colours[k % 6]}">{method}</text>')
    return "\n".join(svg + ["</svg>"])


def write_page(path, all_tables, plots):
    parts = ["<!doctype html><meta charset='utf-8'><title>PhySPRING: reductions</title>",
             "<style>body{font-family:sans-serif;margin:2em}table{border-collapse:collapse}"
             "td,th{padding:2px 10px;text-align:left;border-bottom:1px solid #ddd}</style>",
             "<h1>Ways to reduce a twin</h1><p>Errors in mm: mean over recordings and seeds "
             "[95 % bootstrap interval over recordings]. The paper's are direct, on its own "
             "recordings.</p>", *plots]
    for title, head, body in all_tables:
        rows = "".join("<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in row) + "</tr>"
                       for row in body)
        heads = "".join(f"<th>{html.escape(h)}</th>" for h in head)
        parts.append(f"<h2>{html.escape(title)}</h2><table><tr>{heads}</tr>{rows}</table>")
    path.write_text("\n".join(parts))


def methods_of(text):
    names = text.split(",")
    unknown = [name for name in names if name not in METHODS]
    if unknown:
        raise argparse.ArgumentTypeError(f"no such method: {unknown[0]}")
    return names


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", nargs="+", type=pathlib.Path, metavar="REC.npz")
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, metavar="DIR")
    parser.add_argument("--physpring", type=pathlib.Path,
                        default=pathlib.Path("build/release/physpring"))
    parser.add_argument("--known", type=lambda path: json.loads(pathlib.Path(path).read_text()),
                        default={}, metavar="FILE.json",
                        help="results that are not to be made again, by name (bench/results/)")
    parser.add_argument("--methods", metavar="NAME[,NAME...]", type=methods_of,
                        default=[name for name in METHODS if name not in ABLATIONS],
                        help=f"of {', '.join(METHODS)}")
    parser.add_argument("--ablation", action="store_true",
                        help=f"with {' and '.join(ABLATIONS)}, too")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--no-two-stage", dest="two_stage", action="store_false",
                        help="leave out the two-stage fits (Table 4)")
    parser.add_argument("--train", default="", metavar="OPTIONS", type=str.split,
                        help="further options of `physpring train` for the coarser levels")
    parser.add_argument("--train-dense", default="", metavar="OPTIONS", type=str.split,
                        help="the same for the full fit of level 0")
    parser.add_argument("--train-two-stage", default="", metavar="OPTIONS", type=str.split,
                        help="the same for two-stage fits")
    arguments = parser.parse_args()
    if arguments.ablation:
        arguments.methods += [name for name in ABLATIONS if name not in arguments.methods]
    arguments.output.mkdir(parents=True, exist_ok=True)
    results = train_all(arguments)
    all_tables = list(tables(results, arguments.methods))
    for table in all_tables:
        print_table(*table)
    page = arguments.output / "reductions.html"
    write_page(page, all_tables,
               [plot(results, arguments.methods, "nodes", lambda s, level: s[level]["nodes"]),
                plot(results, arguments.methods, "frames per second, relative to level 0",
                     lambda s, level: s[level]["fps"] / s[0]["fps"])])
    print(f"\npage: {page}")


if __name__ == "__main__":
    main()
