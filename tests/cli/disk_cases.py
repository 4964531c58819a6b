# SPDX-License-Identifier: Apache-2.0
"""Small runs of the commands that write, for tests that disturb them: what they write where, and
whether it is whole. Imported by fault_test.py and kill_test.py."""

import json
import pathlib
import re
import shutil
import struct
import subprocess

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
# What is different each time, and so only looked at for its form.
TIMES = re.compile(r'\.seconds\.json$|eval\.json$|report_of_rollout\.json$|eval\.html$')
# around the rope, whose points are on its surface but for a few millimetres
BOX = ''.join(f'v {x} {y} {z}\n' for x in (-0.205, 0.221) for y in (-0.012, 0.012)
              for z in (0.008, 0.032)) + '''\
f 1 2 4\nf 1 4 3\nf 5 7 8\nf 5 8 6\nf 1 5 6\nf 1 6 2\nf 3 4 8\nf 3 8 7\nf 1 3 7\nf 1 7 5\nf 2 6 8
f 2 8 4
'''


# a file with one splat
NAMES = 'x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3'.split()
SPLAT = ('ply\nformat binary_little_endian 1.0\nelement vertex 1\n' +
         ''.join(f'property float {name}\n' for name in NAMES) + 'end_header\n').encode()
SPLAT += struct.pack('<14f', *[0.0] * 7, *[-5.0] * 3, 1.0, *[0.0] * 3)

CAMERA = '<camera name="above" pos="0 0 0.8" xyaxes="1 0 0 0 1 0"/>'
PICTURES = ['--cameras', 'above', '--size', '64,48', '--duration', '0.07']


class Case:
    """A command whose outputs are all in one folder."""

    def __init__(self, name, words, again=()):
        self.name = name
        self.words = words    # of the command; {out} stands for the folder
        self.again = again    # more words where outputs are there already

    def command(self, program, out, more=()):
        return [program, *(str(word).format(out=out) for word in self.words), *more]


def make_inputs(folder, program, make_small_twin, make_small_task):
    """Twins, recordings, a task and a mesh; returns them by name."""
    demo = REPOSITORY / 'models' / 'demo'
    subprocess.run([make_small_twin, folder], check=True)
    subprocess.run([make_small_task, folder / 'task'], check=True)
    for scene in ('cord', 'rope'):
        subprocess.run([program, 'record', demo / f'{scene}.xml', '-o', folder / f'{scene}.npz',
                        '--duration', '0.3', '--fps', '50'], check=True, capture_output=True)
    (folder / 'box.obj').write_text(BOX)
    seen = (demo / 'cloth.xml').read_text().replace('</worldbody>', CAMERA + '</worldbody>')
    (folder / 'seen.xml').write_text(seen)
    subprocess.run([program, 'record', folder / 'seen.xml', '-o', folder / 'seen.npz', *PICTURES,
                    '--pictures', folder / 'seen'], check=True, capture_output=True)
    (folder / 'one.ply').write_bytes(SPLAT)
    held = folder / "<b>held & 'back'.npz"
    held.rename(folder / 'held.npz')
    return folder


def cases(inputs):
    """One for each command that writes."""
    rope = inputs / 'rope.npz'
    return [
        Case('train', ['train', inputs / 'cord.npz', '-o', '{out}/cord.twin.npz', '--method',
                       'two-stage', '--epochs', '3', '--checkpoint', '0.05', '--log',
                       '{out}/train.log', '--threads', '1'], ['--force']),
        Case('export', ['export', inputs / 'small.twin.npz', '-o', '{out}/model'], ['--force']),
        Case('record', ['record', REPOSITORY / 'models/demo/cord.xml', '-o', '{out}/cord.npz',
                        '--duration', '0.1', '--fps', '50'], ['--force']),
        Case('fit-splats', ['fit-splats', inputs / 'seen', '-o', '{out}/seen.ply', '--count', '50',
                            '--iterations', '20'], ['--force']),
        Case('interior', ['interior', rope, '--mesh', inputs / 'box.obj', '--spacing', '0.008', '-o',
                          '{out}/filled.npz'], ['--force']),
        Case('register', ['register', inputs / 'clouds.npz', '--points', '12', '-o',
                          '{out}/followed.npz'], ['--force']),
        Case('split', ['split', inputs / 'two.npz', '-o', '{out}/parts'], ['--force']),
        Case('splats', ['splats', inputs / 'small.twin.npz', inputs / 'one.ply', '--recording',
                        inputs / 'swing.npz', '-o', '{out}/moved', '--every', '10'], ['--force']),
        Case('eval', ['eval', inputs / 'small.twin.npz', inputs / 'swing.npz', '--json',
                      '{out}/eval.json', '--picture', '{out}/eval.html', '--trajectory',
                      '{out}/motion.npz']),
        Case('track', ['track', inputs / 'small.twin.npz', inputs / 'swing.npz', '--hide', '0.5',
                       '-o', '{out}/states.npz'], ['--force']),
        Case('info', ['info', inputs / 'swing.npz', '--json', '{out}/info.json']),
        Case('diagnose', ['diagnose', inputs / 'small.twin.npz', inputs / 'swing.npz', '--heldout',
                          inputs / 'held.npz', '-o', '{out}/diagnosis', '--resume'], []),
        Case('rollout', ['rollout', inputs / 'task', '--policy', 'random', '--episodes', '3', '-o',
                         '{out}/sweep', '--json', '{out}/report_of_rollout.json']),
    ]


def files_in(folder):
    """Bytes of all files, by name."""
    return {str(path.relative_to(folder)): path.read_bytes()
            for path in sorted(folder.rglob('*')) if path.is_file()}


def is_left_over(name):
    """Whether only a run that ended badly leaves a file or folder of this name."""
    return re.search(r'\.tmp(\.\w+)?$|\.lock$|\.export-\w+', name) is not None


def left_overs(folder):
    return [str(path.relative_to(folder)) for path in folder.rglob('*') if is_left_over(path.name)]


def is_whole(name, content, expected):
    """Whether `content` is what an undisturbed run writes, where `expected` is what one wrote."""
    if name.endswith('.log'):
        return True   # a line a step: what there is of it is right
    if not TIMES.search(name):
        return content == expected
    if name.endswith('.html'):
        return content.rstrip().endswith(b'</html>')
    return form_of(json.loads(content)) == form_of(json.loads(expected))


def form_of(value):
    """JSON without its numbers."""
    if isinstance(value, dict):
        return {key: form_of(part) for key, part in value.items()}
    if isinstance(value, list):
        return [form_of(part) for part in value]
    return 0.0 if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def restore(folder, saved):
    """Makes the folder what it was when files_in told `saved`."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, content in saved.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
