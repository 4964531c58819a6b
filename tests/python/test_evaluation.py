# SPDX-License-Identifier: Apache-2.0
import json
import struct
import zlib

import numpy as np
import physpring
import pytest
from conftest import NODES, run_program


def without_speed(report):
    """A report of `eval` but for the speeds, which differ from run to run."""
    if isinstance(report, dict):
        return {key: without_speed(value) for key, value in report.items() if key != 'fps'}
    return [without_speed(one) for one in report] if isinstance(report, list) else report


def test_is_the_programs(twin, recording, other_recording, tmp_path):
    paths = []
    for one in (recording, other_recording):
        paths.append(tmp_path / (one.name + '.npz'))
        one.save(str(paths[-1]))
    twin.copy().save(tmp_path / 'chain.twin.npz')
    run_program('eval', tmp_path / 'chain.twin.npz', *paths, '--json', tmp_path / 'errors.json',
                '--trajectory', tmp_path / 'points', '--anchor', 5)
    evaluation = physpring.evaluate(tmp_path / 'chain.twin.npz', paths, anchor=5)
    theirs = json.loads((tmp_path / 'errors.json').read_text())
    assert without_speed(evaluation.to_dict()) == without_speed(theirs)
    for number, one in enumerate((recording, other_recording)):
        with np.load(tmp_path / 'points' / (one.name + '.npz')) as points:
            for level in (0, 1):
                ours = evaluation.points(number, level)
                assert np.array_equal(ours.astype(np.float32), points[f'level{level}/points'])
    assert 'level 0' in str(evaluation)
    assert 'level 1' in repr(evaluation)
    assert '<pre>' in evaluation._repr_html_()
    evaluation.save_page(tmp_path / 'page.html')
    assert '<html' in (tmp_path / 'page.html').read_text()


def png(values):
    """A PNG file of (height, width, 3) colours, or (height, width) whole numbers, 8 or 16 bits."""
    def chunk(kind, data):
        return (struct.pack('>I', len(data)) + kind + data +
                struct.pack('>I', zlib.crc32(kind + data)))
    height, width = values.shape[:2]
    bits, colour = 8 * values.dtype.itemsize, 2 if values.ndim == 3 else 0
    rows = values.astype(values.dtype.newbyteorder('>')).reshape(height, -1)
    return (b'\x89PNG\r\n\x1a\n' +
            chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, bits, colour, 0, 0, 0)) +
            chunk(b'IDAT', zlib.compress(b''.join(b'\0' + row.tobytes() for row in rows))) +
            chunk(b'IEND', b''))


def picture_folder(folder, recording, size=96):
    """What a camera before the points sees of them: white squares."""
    centre = recording.points.mean(axis=(0, 1)) - [0, 1, 0]
    axes = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # along y
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes.T, centre
    for kind in ('color', 'mask', 'depth'):
        (folder / kind / 'front').mkdir(parents=True)
    for frame, points in enumerate(recording.points):
        seen = (points - centre) @ axes.T
        pixels = (size * seen[:, :2] / seen[:, 2:] + size / 2).astype(int)
        mask, depth = np.zeros((size, size), np.uint8), np.zeros((size, size), np.uint16)
        for (x, y), z in zip(pixels, seen[:, 2]):
            mask[y - 1:y + 2, x - 1:x + 2] = 255
            depth[y - 1:y + 2, x - 1:x + 2] = round(1e4 * z)
        for kind, values in (('color', np.repeat(mask[..., None], 3, 2)), ('mask', mask),
                             ('depth', depth)):
            (folder / kind / 'front' / f'{frame:05}.png').write_bytes(png(values))
    camera = {'name': 'front', 'width': size, 'height': size, 'fx': size, 'fy': size,
              'cx': size / 2, 'cy': size / 2, 'pose': pose.ravel().tolist()}
    (folder / 'cameras.json').write_text(json.dumps(
        {'format': 'physpring pictures', 'version': 1, 'fps': recording.fps,
         'frames': len(recording.points), 'depth_unit': 1e-4, 'cameras': [camera]}))


def test_judges_pictures_and_other_predictions_as_the_program(twin, recording, tmp_path):
    pictures, splats = tmp_path / 'pictures', tmp_path / 'chain.ply'
    picture_folder(pictures, recording)
    run_program('fit-splats', pictures, '-o', splats, '--count', 50, '--iterations', 20)
    recording.save(tmp_path / 'chain.npz')
    twin.copy().save(tmp_path / 'chain.twin.npz')
    still = np.repeat(physpring.predict(twin, recording)[:1], len(recording.points), axis=0)
    np.savez(tmp_path / 'still.npz', particles=still)
    run_program('eval', tmp_path / 'chain.twin.npz', tmp_path / 'chain.npz', '--images', pictures,
                '--splats', splats, '--prediction', f"still={tmp_path / 'still.npz'}", '--json',
                tmp_path / 'errors.json')
    ours = physpring.evaluate(tmp_path / 'chain.twin.npz', tmp_path / 'chain.npz', images=pictures,
                              splats=splats, cameras='front', predictions={'still': still}).to_dict()
    theirs = json.loads((tmp_path / 'errors.json').read_text())
    assert without_speed(ours) == without_speed(theirs)
    errors = ours['recordings'][0]
    assert errors['images']['levels'][0]['prediction']['iou'] > errors['images']['still']['prediction']['iou']
    assert errors['still']['prediction']['track'] == pytest.approx(
        errors['motionless']['prediction']['track'], rel=0.1)


def test_says_what_is_wrong_with_pictures_and_predictions(twin, recording, other_recording):
    def message(**arguments):
        with pytest.raises(physpring.Error) as error:
            physpring.evaluate(twin, arguments.pop('recordings', recording), **arguments)
        return str(error.value)
    particles = physpring.predict(twin, recording)
    assert message(images='pictures') == 'images and splats go together'
    assert message(cameras=['front']) == 'cameras are of images, which are missing'
    assert 'pictures/cameras.json' in message(images='pictures', splats='chain.ply')
    assert 'has 39 frames, but the recording has 40' in message(predictions={'mine': particles[1:]})
    assert 'expected (frames, ' in message(predictions={'mine': particles[:, 1:]})
    assert "'rigid' cannot name a prediction" in message(predictions={'rigid': particles})
    assert 'are of one recording; there are 2' in message(
        recordings=[recording, other_recording], predictions={'mine': particles})


def test_errors_are_distances(twin, other_recording):
    evaluation = physpring.evaluate(twin, other_recording)
    distance = np.linalg.norm(evaluation.points() - other_recording.points, axis=2).mean(axis=1)
    assert np.allclose(evaluation.errors()[1:], distance[1:])
    with pytest.raises(IndexError):
        evaluation.points(recording=1)


def test_warns_of_a_useless_twin(twin, other_recording):
    useless = twin.copy()
    useless.levels[0].rest_length[:] *= 3
    with pytest.warns(physpring.PhyspringWarning):
        physpring.evaluate(useless, other_recording)


def test_says_what_is_wrong(twin, other_recording):
    with pytest.raises(physpring.Error, match='no recording is given'):
        physpring.evaluate(twin, [])
    fewer = physpring.Recording.from_arrays(points=other_recording.points[:, :5],
                                            controllers=other_recording.controllers, fps=30, mass=0.05)
    with pytest.raises(physpring.Error, match='has 5 points, but twin chain has 10'):
        physpring.evaluate(twin, fewer)


def test_track_finds_what_is_hidden(twin, other_recording, tmp_path):
    found = physpring.track(twin, other_recording, hide=0.5)
    assert found.position.shape == (40, NODES, 3)
    assert len(found.hidden) == 5
    assert found.error < found.error_interpolated
    other_recording.save(tmp_path / 'b.npz')
    twin.copy().save(tmp_path / 't.npz')
    run_program('track', tmp_path / 't.npz', tmp_path / 'b.npz', '-o', tmp_path / 's.npz', '--hide', 0.5)
    with np.load(tmp_path / 's.npz') as states:
        assert np.array_equal(states['position'], found.position.astype(np.float32))
    with pytest.raises(physpring.Error, match='hide is 1'):
        physpring.track(twin, other_recording, hide=1)


def test_is_written_for_rerun(twin, recording, tmp_path):
    chunk = pytest.importorskip('rerun.chunk')
    evaluation = physpring.evaluate(twin, recording)
    evaluation.save_rerun(tmp_path / 'chain.rrd')
    rows, errors = {}, []
    for one in chunk.RrdReader(str(tmp_path / 'chain.rrd')).stream():
        rows[one.entity_path] = rows.get(one.entity_path, 0) + one.num_rows
        if one.entity_path == f'/0_{recording.name}/error/level_1':
            batch = one.to_record_batch()
            column = next(name for name in batch.schema.names if 'scalars' in name.lower())
            errors += [value[0] for value in batch.column(column).to_pylist()]
    frames = len(recording.points)
    for what in ('measured', 'controllers', 'level_0', 'level_1'):
        assert rows[f'/0_{recording.name}/{what}'] == frames
    expected = evaluation.errors(0, 1)
    np.testing.assert_array_equal(errors, expected[np.isfinite(expected)])
