# SPDX-License-Identifier: Apache-2.0
"""loading_test.py LIBRARY: the ways in which Python loads the plugin library, in
the MuJoCo that it was built with and in a later patch of it.

Makes virtual environments with mujoco-core wheels; exits with 77 (skipped) where they cannot be
had.
"""

import os
import shutil
import subprocess
import sys
import tempfile

VERSIONS = ['4.0.0', '4.0.1']

MODEL = """<mujoco>
  <extension><plugin plugin="physpring.springs"><instance name="pair">
    <config key="springs" value="0 1 1 2"/><config key="stiffness" value="10"/>
    <config key="rest_length" value="0.1"/><config key="dashpot" value="0.1"/>
  </instance></plugin><plugin plugin="physpring.force"/></extension>
  <worldbody><body name="pair"><plugin instance="pair"/>NODES</body>
    <body name="hand" mocap="true" pos="0.35 0 0"><plugin instance="pair"/></body></worldbody>
  <sensor><plugin plugin="physpring.force" objtype="body" objname="hand"/></sensor>
</mujoco>"""
NODE = """<body pos="{} 0 0"><inertial pos="0 0 0" mass="0.1" diaginertia="1 1 1"/>
  <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
  <joint type="slide" axis="0 0 1"/></body>"""

# Two nodes 0.2 m apart pull each other, and a hand 0.15 m from one feels its spring; one libmujoco
# is loaded.
PROGRAM = """
import mujoco
{}
model = mujoco.MjModel.from_xml_string({!r})
data = mujoco.MjData(model)
mujoco.mj_step(model, data)
assert data.qvel[0] > 0 > data.qvel[3], data.qvel
assert abs(data.sensordata[0] + 10 * (0.15 - 0.1)) < 0.01, data.sensordata
with open('/proc/self/maps') as maps:
    libraries = {{line.split()[-1] for line in maps if 'libmujoco' in line}}
assert len(libraries) == 1, libraries
"""


def run(*command):
    subprocess.run(command, check=True, stdin=subprocess.DEVNULL)


def expect_step(python, load=''):
    model = MODEL.replace('NODES', NODE.format(0) + NODE.format(0.2))
    run(python, '-c', PROGRAM.format(load, model))


def printed(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def load_in_all_ways(version, library, folder):
    """False where this MuJoCo cannot be had."""
    python = os.path.join(folder, 'venv', 'bin', 'python')
    pip = [python, '-m', 'pip', 'install', '-q']
    try:
        run(sys.executable, '-m', 'venv', os.path.join(folder, 'venv'))
        run(*pip, f'mujoco-core=={version}')
    except subprocess.CalledProcessError:
        return False

    expect_step(python, f'mujoco.mj_loadPluginLibrary({library!r})')

    where = printed(python, '-c', 'import mujoco; print(mujoco.PLUGINS_DIR)')
    dropped = shutil.copy(library, where)
    expect_step(python)
    os.remove(dropped)
    return True


def main(library):
    for version in VERSIONS:
        with tempfile.TemporaryDirectory() as folder:
            if not load_in_all_ways(version, library, folder):
                print(f'skipped: python3-venv or mujoco-core {version} is out of reach')
                return 77
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
