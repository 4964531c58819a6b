# SPDX-License-Identifier: Apache-2.0
import os
import signal
import threading

import numpy as np
import physpring
import pytest
from conftest import QUICK, expect_same_arrays, run_program

LEVELS = {'levels': 2, 'network_epochs': 3}


def test_is_the_programs(recording, tmp_path):
    recording.save(tmp_path / 'chain.npz')
    ours = tmp_path / 'ours' / 'chain.twin.npz'
    ours.parent.mkdir()
    twin = physpring.train(str(tmp_path / 'chain.npz'), output=ours, seed=3, threads=1, **LEVELS,
                           **QUICK)
    theirs = tmp_path / 'chain.twin.npz'
    run_program('train', tmp_path / 'chain.npz', '-o', theirs, '--levels', 2, '--network-epochs', 3,
                '--neighbours', 6, '--cone', 'elliptic', '--controller-velocity', 'on', '--seed', 3)
    expect_same_arrays(ours, theirs)
    twin.save(tmp_path / 'again.twin.npz')
    expect_same_arrays(ours, tmp_path / 'again.twin.npz')

    # and of arrays that were never in a file
    without_file = physpring.train(recording, seed=3, **LEVELS, **QUICK)
    assert (without_file.levels[1].stiffness == twin.levels[1].stiffness).all()
    assert without_file.trained_on == twin.trained_on
    assert without_file.name == 'chain'


def test_tells_how_far_it_is(recording):
    told = []
    where = set()

    def tell(share, status):
        told.append((share, status))
        where.add(threading.current_thread())

    physpring.train(recording, callback=tell, **QUICK)
    shares = [share for share, _ in told]
    assert shares == sorted(shares)
    assert shares[-1] == 1
    assert where == {threading.main_thread()}


def test_ends_after_control_c_and_goes_on(recording, tmp_path):
    interrupted = tmp_path / 'a' / 'chain.twin.npz'
    interrupted.parent.mkdir()

    def interrupt(share, _):
        if share > 0.2:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        physpring.train(recording, output=interrupted, callback=interrupt, **LEVELS, **QUICK)
    assert interrupted.exists()
    with pytest.warns(physpring.PhyspringWarning, match='not finished'):
        physpring.Twin.load(str(interrupted))
    with pytest.raises(physpring.Error, match='unfinished twin; resume goes on'):
        physpring.train(recording, output=interrupted, **LEVELS, **QUICK)
    physpring.train(recording, output=interrupted, resume=True, **LEVELS, **QUICK)
    whole = tmp_path / 'chain.twin.npz'
    physpring.train(recording, output=whole, **LEVELS, **QUICK)
    expect_same_arrays(interrupted, whole)


def test_ends_where_the_callback_throws(recording):
    def fail(share, status):
        raise RuntimeError('enough')

    with pytest.raises(RuntimeError, match='enough'):
        physpring.train(recording, callback=fail, **QUICK)
    physpring.train(recording, **QUICK)  # and nothing is left of the wish to stop


def test_lets_other_threads_work(recording):
    ticks = []
    done = threading.Event()

    def tick():
        while not done.wait(0.005):
            ticks.append(1)

    ticker = threading.Thread(target=tick)
    ticker.start()
    physpring.train(recording, **QUICK)
    done.set()
    ticker.join()
    assert len(ticks) > 3


def test_takes_level_0_from_a_twin(recording, twin):
    again = physpring.train(recording, levels=2, network_epochs=3, from_twin=twin)
    assert (again.levels[0].stiffness == twin.levels[0].stiffness).all()


def test_says_what_is_wrong(recording, other_recording, tmp_path):
    def message(given=recording, **options):
        with pytest.raises(physpring.Error) as caught:
            physpring.train(given, **options)
        return str(caught.value)

    assert message(levels=11) == 'training option levels is 11, expected a whole number from 1 to 10'
    assert message(reduction='kmeans') == 'training option reduction: needs levels 2 or more'
    assert message(method='fast').endswith('expected one of full, smooth, two-stage')
    assert message(level=2).startswith("training option 'level' is unknown; there are ")
    assert message([]) == 'no recording is given'
    assert message(threads=0) == 'threads is 0, expected 1 or more'
    assert message([recording, recording]).endswith('is the same recording as chain.npz')
    assert 'nowhere' in message(output=tmp_path / 'nowhere' / 'a.npz')
    with pytest.raises(TypeError):
        physpring.train(3)
    twin = physpring.train(recording, **QUICK)
    assert message(other_recording, from_twin=twin) == (
        'chain: was not trained on recording chain_b; from_twin needs a twin of the same recordings')
    assert os.listdir(tmp_path) == []


@pytest.mark.filterwarnings('ignore::physpring.PhyspringWarning')
def test_samples_come_from_the_posterior(twin):
    posterior = twin.posterior
    springs = twin.levels[0].spring_count
    directions = len(posterior['drag'])
    assert posterior['stiffness'].shape == posterior['loss_time'].shape == (directions, springs)
    assert posterior['contact'].shape == (directions, 2)
    samples = twin.sample(3, seed=7)
    assert [len(one.levels) for one in samples] == [2, 2, 2]
    again = twin.sample(2, seed=7)
    for one, other in zip(samples, again):
        for level in range(2):
            np.testing.assert_array_equal(one.levels[level].stiffness, other.levels[level].stiffness)
    assert (samples[0].levels[0].stiffness != samples[1].levels[0].stiffness).any()
    # logarithms of factors are a combination of the directions
    change = np.log(samples[0].levels[0].stiffness / twin.levels[0].stiffness)
    z = np.linalg.lstsq(posterior['stiffness'].T, change, rcond=None)[0]
    np.testing.assert_allclose(posterior['stiffness'].T @ z, change, atol=1e-9)
    assert samples[0].posterior is None
    with pytest.raises(physpring.Error, match='no posterior'):
        samples[0].sample(1)
    with pytest.raises(physpring.Error, match='expected 0 to'):
        twin.sample(-1)
