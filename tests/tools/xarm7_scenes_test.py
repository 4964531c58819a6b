#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tasks with the xArm7 give the verdicts of those with the floating gripper:
xarm7_scenes_test.py PHYSPRING PROJECT. Skipped (77) where the robot cannot be downloaded."""
import json
import pathlib
import subprocess
import sys
import tempfile

EPISODES = 2


def verdicts(physpring, task, folder):
    subprocess.run([physpring, 'rollout', task, '--level', '3', '--policy', 'scripted',
                    '--states', 'actions', '--episodes', str(EPISODES), '-o', folder], check=True)
    episodes = [json.loads((folder / 'level3' / f'episode_{i:05d}.json').read_text())
                for i in range(EPISODES)]
    return [(episode['success'], episode['problem']) for episode in episodes]


def main():
    physpring, project = sys.argv[1], pathlib.Path(sys.argv[2])
    made = subprocess.run([project / 'scripts/xarm7'], stdout=subprocess.PIPE, text=True)
    if made.returncode != 0:
        sys.exit(77)
    tasks = made.stdout.split()[-4:]
    assert len(tasks) == 4, made.stdout
    with tempfile.TemporaryDirectory() as folder:
        for task in map(pathlib.Path, tasks):
            with_arm = verdicts(physpring, project / task, pathlib.Path(folder) / 'arm' / task.name)
            floating = verdicts(physpring, project / 'models/scenes' / task.name,
                                pathlib.Path(folder) / 'floating' / task.name)
            print(task.name, with_arm)
            assert with_arm == floating, (with_arm, floating)


if __name__ == '__main__':
    main()
