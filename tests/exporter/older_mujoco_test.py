# SPDX-License-Identifier: Apache-2.0
"""older_mujoco_test.py MODELS: exported models move in the oldest MuJoCo that the docs name, and in
the last one before 4.0, as in 4.0.0.

Makes virtual environments with wheels of MuJoCo; exits with 77 (skipped) where they cannot be had.
"""

import json
import os
import subprocess
import sys
import tempfile

SCENES = ['rope/scene.xml', 'cloth/scene_level2.xml', 'block/scene_level3.xml']
VERSIONS = ['mujoco==3.6.0', 'mujoco==3.17.0', 'mujoco-core==4.0.0']

# Half a thousand steps of each scene: displacements of all joints.
PROGRAM = """
import json, mujoco, sys
ends = []
for path in sys.argv[1:]:
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    for _ in range(500):
        mujoco.mj_step(model, data)
    ends.append(data.qpos.tolist())
print(json.dumps(ends))
"""


def ends_in(version, scenes, folder):
    python = os.path.join(folder, 'bin', 'python')
    try:
        subprocess.run([sys.executable, '-m', 'venv', folder], check=True)
        subprocess.run([python, '-m', 'pip', 'install', '-q', version], check=True)
    except subprocess.CalledProcessError:
        print(f'skipped: python3-venv or the wheel {version} is out of reach')
        sys.exit(77)
    done = subprocess.run([python, '-c', PROGRAM, *scenes], check=True, capture_output=True,
                          text=True)
    return json.loads(done.stdout)


def main(models):
    scenes = [os.path.join(models, scene) for scene in SCENES]
    with tempfile.TemporaryDirectory() as folder:
        *older, today = [ends_in(version, scenes, os.path.join(folder, version))
                         for version in VERSIONS]
    for version, ends in zip(VERSIONS, older):
        for scene, one, other in zip(SCENES, ends, today):
            apart = max(abs(a - b) for a, b in zip(one, other, strict=True))
            size = max(abs(a) for a in other)
            print(f'{version} {scene}: moved by {size:.3g} m, {apart:.2g} m from 4.0.0')
            assert size > 1e-4, 'nothing moved'
            # contacts changed a little between versions
            assert apart < 0.01 * size
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
