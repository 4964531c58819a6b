# SPDX-License-Identifier: Apache-2.0
"""Makes a level-0 twin of PhysTwin's parameters.

Its particles weigh 1 kg each and its spring force is Y (l / L - 1); with m = mass / particles, ours
has    stiffness k = Y m / L,   dashpot c m,   drag as it is.
PhysTwin saves no springs, only Y by index: they are searched again here, in the same order.
"""

import numpy as np

import phystwin_case
from phystwin_springs import find_springs
from safe_pickle import Error

DEFAULT_MASS = 0.1  # kg, what our reader assumes where none is declared
GRAVITY = [0.0, 0.0, -9.8]  # m/s^2


def parameters_of(springs, object_springs, truncate, settings, parameters, checkpoint_path):
    """PhysTwin's parameters as its simulator uses them, with Y of each spring."""
    used = dict(parameters, spring_Y=np.full(len(springs), parameters["global_spring_Y"]))
    if checkpoint_path is not None:
        checkpoint = phystwin_case.read_checkpoint(checkpoint_path)
        stored = (len(checkpoint["spring_Y"]), checkpoint["num_object_springs"])
        if stored != (len(springs), object_springs):
            raise Error(f"{checkpoint_path}: holds {stored[0]} springs, {stored[1]} of them "
                        f"between particles, but the case and its parameters give {len(springs)} "
                        f"and {object_springs}: they are not of one run")
        used.update(checkpoint)
    # PhysTwin's second stage makes these two whole numbers: its Y belong to those
    if truncate if truncate is not None else checkpoint_path is not None:
        used["dashpot_damping"] = float(int(used["dashpot_damping"]))
        used["drag_damping"] = float(int(used["drag_damping"]))
    if not settings.self_collision:
        used["collision_dist"] = 0.0
    return used


def substeps_per_second(settings, note):
    """PhysTwin's sub-steps, as many as fill a frame."""
    frame = settings.substeps * settings.timestep
    substeps = settings.substeps
    if abs(frame * settings.fps - 1) > 0.01:
        note(f"PhysTwin simulates {frame:.4g} s a frame (num_substeps {settings.substeps}, dt "
             f"{settings.timestep:g}), but at {settings.fps:g} frames a second a frame is "
             f"{1 / settings.fps:.4g} s: parameters found so are not those of the object")
        substeps = max(1, round(1 / settings.fps / settings.timestep))
    return int(substeps * settings.fps + 1e-6)


def twin_of(case, springs, rest_length, parameters, mass, settings, note):
    """Arrays of level 0."""
    particles = len(case.tracked) + len(case.interior)
    particle_mass = mass / particles
    position = np.concatenate([case.tracked, case.interior, case.controllers[0]])
    # PhysTwin skips a spring whose Y is not above the least, its dashpot with it
    felt = parameters["spring_Y"] > settings.spring_Y_min
    spring_Y = np.where(felt, np.minimum(parameters["spring_Y"], settings.spring_Y_max), 0.0)
    return {
        "fps": np.float64(settings.fps),
        "gravity": np.array(GRAVITY),
        "level0/position": position.astype(np.float64),
        "level0/mass": np.full(particles, particle_mass),
        "level0/springs": springs,
        "level0/rest_length": rest_length,
        "level0/stiffness": spring_Y * particle_mass / rest_length,
        "level0/dashpot": np.where(felt, parameters["dashpot_damping"] * particle_mass, 0.0),
        "level0/drag": np.float64(parameters["drag_damping"]),
        "level0/contact_radius": np.zeros(particles),
        "level0/restitution": np.float64(np.clip(parameters["collide_elas"], 0, 1)),
        "level0/friction": np.float64(np.clip(parameters["collide_fric"], 0, 2)),
        "level0/object_restitution": np.float64(np.clip(parameters["collide_object_elas"], 0, 1)),
        "level0/object_friction": np.float64(np.clip(parameters["collide_object_fric"], 0, 2)),
        "level0/collision_distance": np.float64(parameters["collision_dist"]),
        "level0/substeps_per_second": np.int32(substeps_per_second(settings, note)),
    }


def convert_twin(case, settings, args, parameters_path, checkpoint_path, note):
    """(arrays of the twin without `meta`, a line about it)."""
    parameters = phystwin_case.read_parameters(parameters_path)
    springs, rest_length, object_springs = find_springs(
        np.concatenate([case.tracked, case.interior]), case.controllers[0], parameters)
    if object_springs == 0:
        raise Error(f"{parameters_path}: object_radius {parameters['object_radius']} m joins no "
                    "two particles")
    used = parameters_of(springs, object_springs, args.truncate, settings, parameters,
                         checkpoint_path)
    arrays = twin_of(case, springs, rest_length, used, args.mass or DEFAULT_MASS, settings, note)
    return arrays, (f"{len(springs)} springs, {object_springs} of them between particles; drag "
                    f"{used['drag_damping']:.6g} 1/s, dashpot {used['dashpot_damping']:.6g} N s/m "
                    f"at 1 kg a particle, collision distance {used['collision_dist']:.6g} m")
