# SPDX-License-Identifier: Apache-2.0
"""gpu_simulators_test.py MODELS PAGE: exported models move in MJX and in MuJoCo Warp, on the CPU, as
in MuJoCo, to what the table of docs/gpu.md (PAGE) says.

Makes virtual environments with wheels; exits with 77 (skipped) where they cannot be had.
"""

import os
import re
import subprocess
import sys
import tempfile

# name in the table -> package
SIMULATORS = {'MJX': 'mujoco-mjx==3.17.0', 'MuJoCo Warp': 'mujoco-warp==4.0.0'}
SCENES = {'rope, level 3': 'rope/scene_level3.xml', 'cloth, level 3': 'cloth/scene_level3.xml',
          'block, level 3': 'block/scene_level3.xml'}

# Half a second from the keyframe `test`: how far the node that differs most is from where MuJoCo
# has it, and how far the one that moves most moves, mm.
PROGRAM = """
import sys
import mujoco
import numpy as np

def in_mjx(model, data, steps):
    import jax
    from mujoco import mjx
    moved = mjx.put_model(model)
    run = jax.jit(lambda x: jax.lax.fori_loop(0, steps, lambda i, y: mjx.step(moved, y), x))
    return np.asarray(run(mjx.put_data(model, data)).qpos)

def in_warp(model, data, steps):
    import mujoco_warp
    moved = mujoco_warp.put_model(model)
    # as much room for contacts as there are nodes
    state = mujoco_warp.put_data(model, data, nconmax=4 * model.ngeom + 64, njmax=16 * model.ngeom + 256)
    for _ in range(steps):
        mujoco_warp.step(moved, state)
    return state.qpos.numpy()[0]

simulator, *paths = sys.argv[1:]
for path in paths:
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key('test').id)
    steps = round(0.5 / model.opt.timestep)
    start = data.qpos.copy()
    end = {'MJX': in_mjx, 'MuJoCo Warp': in_warp}[simulator](model, data, steps)
    for _ in range(steps):
        mujoco.mj_step(model, data)
    farthest = lambda q: 1e3 * np.linalg.norm(q.reshape(-1, 3), axis=1).max()
    print('RESULT', farthest(end - data.qpos), farthest(data.qpos - start))
"""


def table_of(page):
    """{(scene, simulator): mm} of the page."""
    with open(page, encoding='utf-8') as file:
        rows = [[cell.strip() for cell in line.strip().strip('|').split('|')]
                for line in file if line.startswith('|')]
    head = next(row for row in rows if 'MJX' in row)
    return {(row[0], name): float(re.match(r'[\d.]+', row[head.index(name)]).group())
            for row in rows if row[0] in SCENES for name in SIMULATORS}


def run_in(simulator, models, folder):
    """[(apart, moved)] of each scene, mm."""
    python = os.path.join(folder, 'bin', 'python')
    try:
        subprocess.run([sys.executable, '-m', 'venv', folder], check=True)
        subprocess.run([python, '-m', 'pip', 'install', '-q', SIMULATORS[simulator]], check=True)
    except subprocess.CalledProcessError:
        print(f'skipped: python3-venv or the wheel {SIMULATORS[simulator]} is out of reach')
        sys.exit(77)
    done = subprocess.run([python, '-c', PROGRAM, simulator,
                           *[os.path.join(models, scene) for scene in SCENES.values()]],
                          check=True, capture_output=True, text=True, cwd=folder)
    return [tuple(map(float, line.split()[1:]))
            for line in done.stdout.splitlines() if line.startswith('RESULT')]


def main(models, page):
    table = table_of(page)
    wrong = []
    for simulator in SIMULATORS:
        with tempfile.TemporaryDirectory() as folder:
            results = run_in(simulator, os.path.abspath(models), folder)
        for name, (apart, moved) in zip(SCENES, results, strict=True):
            said = table[name, simulator]
            print(f'{simulator}, {name}: {apart:.4f} mm from MuJoCo after {moved:.1f} mm; the page '
                  f'says {said}')
            assert moved > 1, 'nothing moved'
            # other processors round otherwise; below a hundredth of a millimetre nobody cares
            if not said / 3 - 0.01 < apart < 3 * said + 0.01:
                wrong.append((simulator, name))
    assert not wrong, wrong
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
