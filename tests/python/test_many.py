# SPDX-License-Identifier: Apache-2.0
import concurrent.futures
import json
import multiprocessing
import os
import pathlib
import signal

import numpy as np
import physpring
import pytest
from conftest import QUICK, recording_of, run_program
from physpring._mujoco import task_folder

TIMES = ('seconds_per_episode', 'frames_per_second')


def without_times(report):
    if isinstance(report, dict):
        return {key: without_times(value) for key, value in report.items() if key not in TIMES}
    return [without_times(one) for one in report] if isinstance(report, list) else report


def same_files(one, other):
    """Two folders of episodes hold the same, but for the times."""
    def files(folder):
        return {path.relative_to(folder).as_posix(): path.read_bytes()
                for path in pathlib.Path(folder).rglob('*')
                if path.is_file() and not path.name.startswith('.')
                and not path.name.endswith('.seconds.json')}
    return files(one) == files(other)


@pytest.fixture(name='theirs', scope='module')
def fixture_theirs(tmp_path_factory):
    """What the program does."""
    pytest.importorskip('mujoco')
    folder = tmp_path_factory.mktemp('theirs')
    run_program('rollout', task_folder('rope_routing'), '--level', '2,3', '--episodes', 4, '--seed', 4,
                '--action-noise', 0.03, '-o', folder / 'out', '--json', folder / 'report.json')
    return folder


SWEEP = {'levels': [2, 3], 'episodes': 4, 'seed': 4, 'action_noise': 0.03}


def test_sweep_is_the_programs(theirs, tmp_path):
    told = []
    swept = physpring.sweep('rope_routing', output=tmp_path / 'out', workers=2,
                            callback=lambda share, status: told.append(share), **SWEEP)
    report = json.loads((theirs / 'report.json').read_text())
    assert without_times(swept.to_dict()) == without_times(report)
    assert same_files(tmp_path / 'out', theirs / 'out')
    assert told[-1] == 1
    assert 'level' in str(swept)

    # what is damaged is run again, the rest is not
    damaged = tmp_path / 'out' / 'level3' / 'episode_00002.npz'
    damaged.write_bytes(b'')
    before = (tmp_path / 'out' / 'level3' / 'episode_00001.npz').stat().st_mtime_ns
    with pytest.warns(physpring.PhyspringWarning, match='the episode is run again'):
        again = physpring.sweep('rope_routing', output=tmp_path / 'out', workers=1, **SWEEP)
    assert without_times(again.to_dict()) == without_times(report)
    assert same_files(tmp_path / 'out', theirs / 'out')
    assert (tmp_path / 'out' / 'level3' / 'episode_00001.npz').stat().st_mtime_ns == before
    with pytest.raises(physpring.Error, match='sweep.json'):
        physpring.sweep('rope_routing', output=tmp_path / 'out', **{**SWEEP, 'seed': 5})


def kill_once(flag, work, *arguments):
    """`work` in a worker, which dies the first time."""
    try:
        os.close(os.open(flag, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return work(*arguments)
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError('is dead')


def test_sweep_survives_a_killed_worker(theirs, tmp_path, monkeypatch):
    from physpring import _many
    spread = _many._spread
    monkeypatch.setattr(_many, '_spread', lambda work, jobs, executor, workers: spread(
        kill_once, {key: (tmp_path / 'flag', work, *job) for key, job in jobs.items()}, executor,
        workers))
    swept = physpring.sweep('rope_routing', output=tmp_path / 'out', workers=2, **SWEEP)
    assert (tmp_path / 'flag').exists()
    report = json.loads((theirs / 'report.json').read_text())
    assert without_times(swept.to_dict()) == without_times(report)
    assert same_files(tmp_path / 'out', theirs / 'out')


def test_sweep_takes_an_executor(theirs):
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context('spawn')) as executor:
        swept = physpring.sweep('rope_routing', executor=executor, **SWEEP)
    report = json.loads((theirs / 'report.json').read_text())
    assert without_times(swept.to_dict()) == without_times(report)


def test_sweep_on_dask(theirs, tmp_path):
    distributed = pytest.importorskip('distributed')
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            workers = iter(cluster.workers.values())
            killed = []

            def kill(share, _):
                if share > 0.2 and not killed:
                    killed.append(next(workers).pid)
                    os.kill(killed[0], signal.SIGKILL)

            swept = physpring.sweep('rope_routing', executor=client.get_executor(), callback=kill,
                                    output=tmp_path / 'out', **SWEEP)
    assert killed
    report = json.loads((theirs / 'report.json').read_text())
    assert without_times(swept.to_dict()) == without_times(report)
    assert same_files(tmp_path / 'out', theirs / 'out')


def test_sweep_says_what_is_wrong(theirs):
    assert theirs
    with pytest.raises(physpring.Error, match="policy is 'best'"):
        physpring.sweep('rope_routing', 'best')
    with pytest.raises(physpring.Error, match='has levels 0 to 3, not 9'):
        physpring.sweep('rope_routing', levels=[9])
    with pytest.raises(physpring.Error, match='different'):
        physpring.sweep('rope_routing', levels=[1, 1])
    with pytest.raises(physpring.Error, match='nothing.npz'):
        physpring.sweep('rope_routing', 'replay:nothing.npz', levels=[3], workers=1)


def test_many_trainings_are_single_ones(recording, tmp_path):
    objects = {'one': recording, 'two': recording_of('chain_c', 7)}
    twins = physpring.train_many(objects, workers=2, output=tmp_path / 'twins', **QUICK)
    assert list(twins) == ['one', 'two']
    for name, given in objects.items():
        alone = physpring.train(given, **QUICK)
        assert np.array_equal(twins[name].levels[0].stiffness, alone.levels[0].stiffness)
        assert (tmp_path / 'twins' / f'{name}.twin.npz').exists()
    again = physpring.train_many(objects, workers=2, output=tmp_path / 'twins', **QUICK)
    assert np.array_equal(again['one'].levels[0].mass, twins['one'].levels[0].mass)
    with pytest.raises(physpring.Error, match='is a twin of other recordings'):
        physpring.train_many({'one': objects['two']}, output=tmp_path / 'twins', **QUICK)
    with pytest.raises(physpring.Error, match='levels is 11'):
        physpring.train_many(objects, workers=1, levels=11)
