# SPDX-License-Identifier: Apache-2.0
import json

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
