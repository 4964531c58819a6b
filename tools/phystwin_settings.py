# SPDX-License-Identifier: Apache-2.0
"""Reads how a PhysTwin case was filmed and simulated: frame rate, z up or down, sub-steps.

The rate is the cameras' `fps` in the case's metadata.json, else `FPS` of PhysTwin's configuration.
The rest is the configuration's. It is a yaml file in the case's folder, or configs/cloth.yaml or
configs/real.yaml above it, which PhysTwin chooses by the case's name. What nothing says has
PhysTwin's default, and the caller is told.
"""

import collections
import json
import math
import os
import re
import stat

from safe_pickle import Error

FPS = 30.0  # 1/s, PhysTwin's default
LEAST_FPS, MOST_FPS = 0.1, 1e6  # 1/s, what our recordings may have
MOST_TEXT = 1 << 22  # bytes; a longer text is none of PhysTwin's

Settings = collections.namedtuple("Settings", [
    "fps",  # frames a second
    "reverse_z",  # whether z points down; None: nothing says it
    "self_collision",  # whether particles collide with each other
    "timestep",  # s, PhysTwin's sub-step
    "substeps",  # PhysTwin's sub-steps a frame
    "spring_Y_min", "spring_Y_max",  # N; its simulator skips springs up to the one, and clamps
    "frame_num",  # frames that were filmed, or None
])


def read_text(path):
    """The text in `path`, which must be a file of moderate size."""
    try:
        with open(path, "rb") as file:
            if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                raise Error(f"{path}: is no file")
            data = file.read(MOST_TEXT + 1)
    except OSError as error:
        raise Error(f"{path}: {error.strerror}") from None
    if len(data) > MOST_TEXT:
        raise Error(f"{path}: is longer than {MOST_TEXT} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise Error(f"{path}: {error}") from None


def parse_json(text, path):
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise Error(f"{path}: {error}") from None


def read_json(path):
    return parse_json(read_text(path), path)


def read_object(path):
    """The JSON object in `path` as {key in small letters: value}."""
    return _lower(read_json(path), path)


def _lower(values, path):
    if not isinstance(values, dict):
        raise Error(f"{path}: holds no keys with values")
    return {key.lower(): value for key, value in values.items() if value is not None}


_YAML_LINE = re.compile(r"""["']?(\w+)["']?\s*:\s+("[^"]*"|'[^']*'|.*?)\s*(?:\s\#.*)?$""")


def read_yaml(path):
    """{key in small letters: text} of the lines `key: value`; PhysTwin's files have no others."""
    text = read_text(path)
    if text.lstrip().startswith("{"):  # JSON is yaml
        return _lower(parse_json(text, path), path)
    found = {}
    for line in text.splitlines():
        match = _YAML_LINE.match(line)
        if match:
            found[match[1].lower()] = match[2].strip("\"'")
    return {key: value for key, value in found.items() if value not in ("", "~", "null")}


def find_configuration(folder):
    """The configuration's path, or None."""
    name = "cloth.yaml" if "cloth" in folder.name or "package" in folder.name else "real.yaml"
    own = sorted(path for ending in ("*.yaml", "*.yml") for path in folder.glob(ending))
    if len(own) > 1:
        own = [path for path in own if path.name == name]
        if not own:
            raise Error(f"{folder}: more than one configuration, choose one with --config")
    paths = own + [parent / "configs" / name for parent in list(folder.parents)[:3]]
    return next((path for path in paths if path.is_file()), None)


def number_of(values, key, path, low, high):
    """The number values[key] within [low, high], or None where there is none."""
    value = values.get(key.lower())
    if value is None:
        return None
    try:
        if isinstance(value, (bool, list, dict)):
            raise ValueError
        number = float(value)
    except (ValueError, OverflowError):
        number = math.nan
    if not low <= number <= high:
        raise Error(f"{path}: {key} is {str(value)[:40]}, expected {low:g} to {high:g}")
    return number


def truth_of(values, key, path):
    """Whether values[key] is true, or None where there is none."""
    value = values.get(key.lower())
    if value is None:
        return None
    words = {"true": True, "yes": True, "on": True, "1": True,
             "false": False, "no": False, "off": False, "0": False}
    word = str(value)[:40].lower()
    if word not in words:
        raise Error(f"{path}: {key} is {word}, expected true or false")
    return words[word]


def _shown(value):
    return str(value).lower() if isinstance(value, bool) else f"{value:g}"


def _choose(what, flag, given, said, note):
    """The value `given` by a flag; else the first of `said` ((path, value or None), ...)."""
    said = [(path, value) for path, value in said if value is not None]
    if given is not None:
        return given
    if not said:
        return None
    if any(value != said[0][1] for _, value in said):
        (path, value), (other_path, other) = said
        note(f"{what}: {_shown(value)} in {path}, but {_shown(other)} in {other_path}: "
             f"{_shown(value)} is taken ({flag} chooses otherwise)")
    return said[0][1]


def read_settings(folder, args, note):
    """The case's `Settings`. args.fps, args.reverse_z and args.self_collision are flags, or None,
    args.config is a path or None; `note` is called with each thing that is assumed."""
    metadata_path = folder / "metadata.json"
    metadata = read_object(metadata_path) if metadata_path.exists() else {}
    path = args.config or find_configuration(folder)
    config = read_yaml(path) if path else {}

    def either(default, key, low, high):
        number = number_of(config, key, path, low, high)
        return default if number is None else number

    fps = _choose("frames a second", "--fps", args.fps, [
        (metadata_path, number_of(metadata, "fps", metadata_path, LEAST_FPS, MOST_FPS)),
        (path, number_of(config, "FPS", path, LEAST_FPS, MOST_FPS))], note)
    if fps is None:
        note(f"nothing says the frame rate (metadata.json, a configuration, --fps): PhysTwin's "
             f"{FPS:g} frames a second are assumed")
        fps = FPS
    self_collision = args.self_collision
    if self_collision is None:
        self_collision = truth_of(config, "self_collision", path)
    if self_collision is None:  # PhysTwin chooses its configuration by name, too
        self_collision = "cloth" in folder.name or "package" in folder.name
    return Settings(
        fps=fps,
        reverse_z=_choose("reverse_z", "--reverse-z", args.reverse_z, [
            (metadata_path, truth_of(metadata, "reverse_z", metadata_path)),
            (path, truth_of(config, "reverse_z", path))], note),
        self_collision=self_collision,
        timestep=either(5e-5, "dt", 1e-7, 1),
        substeps=round(either(667, "num_substeps", 1, 1e7)),
        spring_Y_min=either(0.0, "spring_Y_min", 0, 1e12),
        spring_Y_max=either(1e5, "spring_Y_max", 0, 1e12),
        frame_num=number_of(metadata, "frame_num", metadata_path, 0, 2 ** 31))
