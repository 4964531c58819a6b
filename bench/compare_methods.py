#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Table 1 of the paper on finite-element bodies, with pictures: compare_methods.py PROGRAM OUTPUT

The rope, the cloth and the block of models/demo, with a texture and three cameras: recorded with
pictures by MuJoCo, whose bodies have nothing of a twin or of splats. Then level 0 to 3 of a twin, a
twin as PhysTwin trains it (two stages), Spring-Gaus, GS-Dynamics and EvoMesh (bench/methods), and a
body that stays where it is; all of them move the same splats, which fit-splats made of frame 0. The
black boxes also get other recordings of the object. The first 70 % of the frames are for fitting.

A run that was stopped goes on. Needs NumPy, and torch for the other methods. The tables are in
OUTPUT/tables.md, pages with pictures in OUTPUT/OBJECT/*.html.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ET

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
OBJECTS = ("rope", "cloth", "block")
METHODS = {"Spring-Gaus": "spring_gaus", "GS-Dynamics": "gs_dynamics", "EvoMesh": "evomesh"}
CAMERAS = {"front": (-100, 30), "left": (140, 35), "right": (20, 45)}  # azimuth, elevation: degrees
FIELD_OF_VIEW = 40  # degrees, upright
WIDTH, HEIGHT = 640, 480
OTHERS = 6  # recordings of other motions, for the black boxes
COLUMNS = {"cd": ("CD", "mm", 1e3, 1), "track": ("track", "mm", 1e3, 1),
           "iou": ("IoU", "%", 100, 1), "psnr": ("PSNR", "dB", 1, 2), "ssim": ("SSIM", "", 1, 3)}


class Once:
    """Work whose result is a file, which is not done again."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        folder.mkdir(parents=True, exist_ok=True)

    def path(self, name):
        return self.folder / name

    def seconds(self):
        """Of each file that is done."""
        path = self.path("seconds.json")
        return json.loads(path.read_text()) if path.exists() else {}

    def run(self, name, *arguments):
        """`physpring ARGUMENTS`, after which OUTPUT/OBJECT/`name` is there; its seconds are kept."""
        if name in self.seconds():
            return
        begin = time.monotonic()
        print(f"{self.folder.name}: {name}", flush=True)
        done = subprocess.run([self.program, *map(str, arguments)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        with open(self.path("log.txt"), "a") as log:
            log.write(f"== {name}\n{done.stdout}\n")
        if done.returncode != 0:
            sys.exit(f"{name}: {done.stdout.strip().splitlines()[-1]}")
        self.keep_seconds(name, time.monotonic() - begin)

    def keep_seconds(self, name, seconds):
        done = self.seconds() | {name: round(seconds, 1)}
        self.path("seconds.json").write_text(json.dumps(done, indent=1) + "\n")


def textured(object_name, box):
    """The demo's scene with a texture on the object, and cameras that see the box (2,3) in m."""
    tree = ET.parse(ROOT / f"models/demo/{object_name}.xml")
    scene = tree.getroot()
    assets = ET.SubElement(scene, "asset")
    ET.SubElement(assets, "texture", name="pattern", type="2d", builtin="checker", width="256",
                  height="256", rgb1="0.85 0.35 0.2", rgb2="0.15 0.35 0.7", mark="random",
                  markrgb="0.95 0.9 0.5", random="0.02")
    ET.SubElement(assets, "material", name="pattern", texture="pattern", texrepeat="1 1",
                  specular="0.1")
    world, flex = scene.find("worldbody"), scene.find("worldbody/flexcomp")
    flex.set("material", "pattern")
    count = [int(n) for n in flex.get("count").split()]
    spacing = [float(s) for s in flex.get("spacing").split()]
    grid = np.stack(np.meshgrid(*[np.arange(n) * s for n, s in zip(count, spacing)], indexing="ij"),
                    -1).reshape(-1, 3)
    period = 8 * max(spacing)  # a checker of two squares
    places = (grid[:, :2] + 0.37 * grid[:, 2:]) / period
    flex.set("texcoord", " ".join(f"{number:.5f}" for number in places.ravel()))
    ET.SubElement(world, "light", pos="0.5 -1 1.5", dir="-0.3 0.6 -0.8", diffuse="0.4 0.4 0.4")
    centre, radius = box.mean(axis=0), np.linalg.norm(box[1] - box[0]) / 2
    for name, (azimuth, elevation) in CAMERAS.items():
        azimuth, elevation = np.radians(azimuth), np.radians(elevation)
        back = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation),
                         np.sin(elevation)])
        distance = 1.05 * radius / np.sin(np.radians(FIELD_OF_VIEW / 2))
        right = np.cross([0, 0, 1], back)
        right /= np.linalg.norm(right)
        up = np.cross(back, right)
        ET.SubElement(world, "camera", name=name, fovy=str(FIELD_OF_VIEW),
                      pos=numbers(centre + distance * back), xyaxes=numbers([*right, *up]))
    return ET.tostring(scene, encoding="unicode")


def numbers(values):
    return " ".join(f"{value:.6g}" for value in values)


def record(once, object_name):
    """The recording with pictures, other motions, and the object's splats."""
    noise = ("--noise", "0.001", "--occlusion", "0.1")
    once.run("box.npz", "record", ROOT / f"models/demo/{object_name}.xml", "-o", once.path("box.npz"),
             "--force")
    points = np.load(once.path("box.npz"))["points"]
    scene = once.path("scene.xml")
    box = np.stack([points.min((0, 1)), points.max((0, 1))])
    scene.write_text(textured(object_name, box))
    if "object.npz" not in once.seconds():
        shutil.rmtree(once.path("pictures"), ignore_errors=True)
    once.run("object.npz", "record", scene, "-o", once.path("object.npz"), *noise, "--seed", 11,
             "--pictures", once.path("pictures"), "--cameras", ",".join(CAMERAS),
             "--size", f"{WIDTH},{HEIGHT}", "--force")
    for number in range(OTHERS):
        name = f"other_{number}.npz"
        once.run(name, "record", scene, "-o", once.path(name), *noise, "--vary", "0.03",
                 "--seed", 100 + number, "--force")
    once.run("object.ply", "fit-splats", once.path("pictures"), "-o", once.path("object.ply"), "--force")


def train(once):
    common = (once.path("object.npz"), "--precision", "float", "--seed", 1, "--resume")
    once.run("ours.twin.npz", "train", *common, "-o", once.path("ours.twin.npz"), "--levels", 4)
    once.run("two_stage.twin.npz", "train", *common, "-o", once.path("two_stage.twin.npz"),
             "--levels", 1, "--method", "two-stage")


def predict(once, methods):
    """{name: file} of the other methods that ran; a method that does not run says why."""
    found = {}
    for name in methods:
        path = once.path(f"{METHODS[name]}.npz")
        failed = path.with_suffix(".failed")
        if not path.exists() and not failed.exists():
            predict_one(once, name, path, failed)
        if path.exists():
            found[name] = path
    return found


def predict_one(once, name, path, failed):
    import importlib

    from methods.recorded import Recorded
    print(f"{once.folder.name}: {name}", flush=True)
    method = importlib.import_module(f"methods.{METHODS[name]}")
    begin = time.monotonic()
    try:
        others = [Recorded(once.path(f"other_{number}.npz"), whole=True)
                  for number in range(OTHERS)]
        particles = method.predict(Recorded(once.path("object.npz")),
                                   lambda line: print(f"  {line}", flush=True), others)
        particles = particles.numpy().astype(float)
        if not np.isfinite(particles).all() or np.abs(particles).max() > 100:
            raise RuntimeError("the prediction leaves all bounds")
    except RuntimeError as error:
        failed.write_text(f"{error}\n")
        print(f"  {error}", flush=True)
        return
    once.keep_seconds(name, time.monotonic() - begin)
    np.savez(path, particles=particles)


def evaluate(once, predictions):
    """Rows by name: {"fit": {column: value}, "prediction": ...}."""
    named = [word for name, path in predictions.items()
             for word in ("--prediction", f"{name}={path}")]
    pictures = ("--images", once.path("pictures"), "--splats", once.path("object.ply"))
    suffix = "_".join(METHODS[name] for name in predictions) or "twins"
    rows = {}
    for twin, words in (("two_stage", ()), ("ours", named)):
        report = f"{twin}_{suffix}.json"
        once.run(report, "eval", once.path(f"{twin}.twin.npz"), once.path("object.npz"), *pictures,
                 *words, "--json", once.path(report), "--picture",
                 once.path(f"{twin}_{suffix}.html"), "--threads", 2)
        found = json.loads(once.path(report).read_text())["recordings"][0]
        for number, level in enumerate(found["levels"]):
            name = "two-stage" if twin == "two_stage" else f"level {number}"
            rows[name] = columns(level, found["images"]["levels"][number])
        for name in ("motionless", *predictions):
            if name in found:
                rows[name] = columns(found[name], found["images"][name])
    return rows


def columns(errors, images):
    return {part: {"cd": errors[part]["cd"], "track": errors[part]["track"],
                   **{key: images[part][key] for key in ("iou", "psnr", "ssim", "box_psnr",
                                                         "box_ssim")}}
            for part in ("fit", "prediction")}


def table(rows):
    heads = [f"{name} {unit}".strip() for name, unit, _, _ in COLUMNS.values()]
    lines = ["| | " + " | ".join(heads) + " | future: " + " | ".join(heads) + " |",
             "|---" * (1 + 2 * len(COLUMNS)) + "|"]
    for name, row in rows.items():
        cells = [f"{scale * row[part][key]:.{digits}f}" if row[part][key] is not None else "-"
                 for part in ("fit", "prediction")
                 for key, (_, _, scale, digits) in COLUMNS.items()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def mean_of(all_rows):
    """Of the rows that all objects have."""
    names = [name for name in all_rows[0] if all(name in rows for rows in all_rows)]
    return {name: {part: {key: float(np.mean([rows[name][part][key] for rows in all_rows]))
                          for key in COLUMNS}
                   for part in ("fit", "prediction")} for name in names}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path, help="physpring")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--objects", default=",".join(OBJECTS))
    parser.add_argument("--methods", default=",".join(METHODS), help="may be empty")
    arguments = parser.parse_args()
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
    methods = [name for name in arguments.methods.split(",") if name]
    text, all_rows = "", []
    for object_name in arguments.objects.split(","):
        once = Once(arguments.program.resolve(), arguments.output / object_name)
        record(once, object_name)
        train(once)
        rows = evaluate(once, predict(once, methods))
        all_rows.append(rows)
        once.path("rows.json").write_text(json.dumps(rows, indent=1) + "\n")
        text += f"\n**{object_name}**\n\n{table(rows)}"
        (arguments.output / "tables.md").write_text(text)
    if len(all_rows) > 1:
        text += f"\n**mean**\n\n{table(mean_of(all_rows))}"
        (arguments.output / "tables.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
