# SPDX-License-Identifier: Apache-2.0
"""What users try that is wrong: one line says so, nothing crashes, and nothing goes on wrongly."""
import pickle
import signal
import threading
import time

import numpy as np
import physpring
import pytest
from conftest import NODES, recording_of, swing


def message(call, *arguments, **named):
    with pytest.raises(physpring.Error) as caught:
        call(*arguments, **named)
    return str(caught.value)


def run_together(*works):
    """What threads raise that run these at once."""
    raised = []

    def run(work):
        try:
            work()
        except Exception as error:  # pylint: disable=broad-except
            raised.append(error)

    threads = [threading.Thread(target=run, args=(work,)) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return raised


def test_state_of_another_simulator(twin):
    dense, coarse = physpring.Simulator(twin, 0), physpring.Simulator(twin, 1)
    faster = physpring.Simulator(twin, 0, fps=60)
    for other in (coarse, faster):
        assert 'another level or other frames' in message(setattr, dense, 'state', other.state)
    with pytest.raises(TypeError, match='SimulatorState'):
        dense.state = 'abc'
    assert dense.step().shape == (NODES, 3)
    parts = dense.state.__getstate__()
    with pytest.raises(physpring.Error, match='three parts'):
        physpring.SimulatorState.__new__(physpring.SimulatorState).__setstate__(())
    short = physpring.SimulatorState.__new__(physpring.SimulatorState)
    short.__setstate__((parts[0], parts[1][:3], parts[2]))
    assert 'another level' in message(setattr, dense, 'state', short)
    assert pickle.loads(pickle.dumps(dense.state)).frame == 1


@pytest.mark.parametrize('name, value, word', [
    ('position', np.nan, 'position'), ('mass', -1.0, 'mass'), ('stiffness', -5.0, 'stiffness'),
    ('rest_length', 0.0, 'rest'), ('dashpot', np.nan, 'dashpot'), ('contact_radius', np.nan, 'radius')])
def test_level_with_wrong_numbers(twin, other_recording, tmp_path, name, value, word):
    broken = twin.copy()
    getattr(broken.levels[0], name)[:] = value
    for call in (lambda: physpring.predict(broken, other_recording),
                 lambda: physpring.evaluate(broken, other_recording),
                 lambda: physpring.track(broken, other_recording, hide=0.3),
                 lambda: physpring.diagnose(broken, other_recording),
                 lambda: physpring.export(broken, tmp_path / 'm'),
                 lambda: physpring.Simulator(broken), broken.levels[0].largest_timestep,
                 lambda: broken.save(tmp_path / 'a.npz')):
        assert word in message(call)
    assert list(tmp_path.iterdir()) == []


def test_views_take_operators(twin):
    changed = twin.copy()
    level = changed.levels[0]
    level.stiffness *= 2
    level.mass = 0.01
    assert np.array_equal(level.stiffness, 2 * twin.levels[0].stiffness)
    assert (level.mass == 0.01).all()
    with pytest.raises(ValueError):
        level.stiffness = [1, 2]
    with pytest.raises(ValueError):
        changed.levels[1].assignment[:] = 0


def test_threads_share_a_simulator(twin):
    simulator = physpring.Simulator(twin)
    path = swing(1)[1][:10]
    stiffness = simulator.parameters()['stiffness']
    expected = simulator.rollout(path)[0]
    wrong = []

    def roll():
        for _ in range(60):
            if not np.array_equal(simulator.rollout(path)[0], expected):
                wrong.append(1)

    def change():
        for _ in range(300):
            simulator.set(stiffness=stiffness)

    assert run_together(roll, roll, change, change) == []
    assert not wrong


def test_numbers_of_other_kinds(twin):
    simulator = physpring.Simulator(twin)
    path = swing(1)[1][:4]
    for given in (path + 1j, path.astype(str), path > 0, np.ma.masked_array(path, mask=True)):
        assert 'controllers is no array of numbers' in message(simulator.rollout, given)
    assert np.array_equal(simulator.rollout(path.astype('>f8'))[0], simulator.rollout(path)[0])

    points, hands = swing(1)
    expected = recording_of('chain', 1).points
    hidden = np.ma.masked_array(points, mask=False)
    hidden[5, 3] = np.ma.masked
    for given in (points.astype('>f8'), points.astype(np.longdouble), points.astype(object)):
        made = physpring.Recording.from_arrays(points=given, controllers=hands, fps=30, mass=0.05)
        assert np.array_equal(made.points, expected)
    made = physpring.Recording.from_arrays(points=hidden, controllers=hands, fps=30, mass=0.05)
    assert np.isnan(made.points[5, 3]).all()
    assert np.isnan(made.points).sum() == 3
    for name in ('', 'a/b'):
        assert 'name' in message(physpring.Recording.from_arrays, name=name, points=points, fps=30)


def test_options_out_of_bounds(twin, recording, tmp_path):
    assert message(physpring.train, recording, seed=-1) == 'seed is -1, expected 0 or more'
    assert message(physpring.train, recording, threads=1.5) == 'threads is 1.5, expected a whole number'
    assert message(physpring.train, recording, output='').startswith('output is empty')
    assert message(physpring.train, recording, resume=True).startswith('resume needs output')
    assert 'checkpoint_interval' in message(physpring.train, recording, checkpoint_interval=np.nan)
    assert 'option of the training' in message(physpring.train, recording, latent=np.nan)
    assert message(physpring.evaluate, twin, recording, substeps=0) == 'substeps is 0, expected 1 or more'
    assert message(physpring.track, twin, recording, hide=0.5, substeps=10**6 + 1) == (
        'substeps is 1000001, expected at most 1000000')
    assert message(physpring.evaluate, twin, recording, anchor=-1) == 'anchor is -1, expected 1 or more'
    assert 'timestep' in message(physpring.export, twin, tmp_path / 'm', timestep=-1)
    assert message(physpring.predict, twin, [recording, recording]).startswith('2 recordings are given')
    physpring.export(twin, tmp_path / 'm')
    assert message(physpring.export, twin, tmp_path / 'm').endswith('force overwrites')
    with pytest.raises(TypeError, match='Recording.from_arrays takes arrays'):
        physpring.train(recording.points)
    with pytest.raises(TypeError, match='a twin is'):
        physpring.evaluate(recording, twin)


def test_masses_that_differ_are_told(recording):
    points, hands = swing(2)
    heavy = physpring.Recording.from_arrays(name='heavy', points=points, controllers=hands, fps=30,
                                            mass=5)
    with pytest.warns(physpring.PhyspringWarning, match='heavy: says that the object weighs 5 kg'):
        physpring.train([recording, heavy], neighbours=6, cone='elliptic', controller_velocity='on')


@pytest.fixture(name='env')
def fixture_env():
    pytest.importorskip('mujoco')
    pytest.importorskip('gymnasium')
    import physpring.envs  # pylint: disable=import-outside-toplevel
    env = physpring.envs.TaskEnv('rope_routing', 3)
    env.reset(seed=0)
    return env


def test_environments(env):
    from physpring.envs import TaskEnv, TaskVectorEnv
    assert message(env.reset, options={'episode': -1}) == 'episode is -1, expected 0 or more'
    assert 'quaternion needs position' in message(env.reset, options={'quaternion': [1, 0, 0, 0]})
    good = env.policy_action()
    message(env.reset, options={'position': [1e300] * 3})
    assert 'no episode has begun' in message(env.step, good)
    env.reset(seed=0)
    for named in ({'action_noise': -1}, {'start_noise': np.nan}, {'width': -5}, {'height': 10**6}):
        assert next(iter(named)) in message(TaskEnv, 'rope_routing', 3, **named)
    assert 'cloth_folding, rope_routing, t_push, toy_packing' in message(TaskEnv, 'RopeRouting')

    vector = TaskVectorEnv(2, 'rope_routing', 3)
    vector.reset(seed=0)
    before = [scene.particles for scene in vector._scenes]
    message(vector.step, np.stack([good, good * np.nan]))
    assert all(np.array_equal(one, scene.particles) for one, scene in zip(before, vector._scenes))
    assert 'one entry' in message(vector.reset, seed=[1])
    assert "'foo'" in message(vector.reset, options={'foo': 1})
    vector.reset(seed=np.int64(3))


def test_environment_in_two_threads(env):
    good = env.policy_action()

    def steps():
        for _ in range(20):
            env.step(good)

    raised = run_together(steps, steps, steps)
    assert all('at work in another thread' in str(error) for error in raised)


def test_a_policy_server_is_not_waited_for_after_control_c(env):
    before = time.monotonic()
    threading.Timer(1, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        env.policy_action('ws://localhost:1')
    assert time.monotonic() - before < 20  # and not the minute that a server is waited for


def test_sweeps(env):
    assert env
    assert 'first is -1' in message(physpring.sweep, 'rope_routing', first=-1)
    assert 'action_noise' in message(physpring.sweep, 'rope_routing', action_noise=-1)
    assert 'levels' in message(physpring.sweep, 'rope_routing', levels='3')
    assert 'workers is 0' in message(physpring.sweep, 'rope_routing', levels=[3], workers=0)


def test_planners(twin):
    pytest.importorskip('scipy')
    from physpring.planning import Planner
    goal = [[0.1, 0, 0.8]]

    def refuses(**how):
        return message(Planner, twin, **{'target_points': goal, 'target_nodes': [NODES - 1], **how})

    for grasps in ([[]], [], [[0], [0]], [[5]], [[-1]]):
        assert 'grasps' in refuses(grasps=grasps)
    for obstacles in ([[np.nan] * 4], [[0, 0, 1]], [[0, 0, 0, -1]]):
        assert 'obstacles' in refuses(obstacles=obstacles)
    assert 'max_stretch' in refuses(max_stretch=np.nan)
    assert 'max_speed' in refuses(max_speed=np.inf)
    assert 'names a node twice' in refuses(target_points=goal * 2, target_nodes=[0, 0])
    assert 'has no number' in refuses(target_points=[[np.nan] * 3])
    for cost in (lambda x: (np.nan, x), lambda x: (1.0, np.zeros(3))):
        assert 'target_cost gave' in message(Planner(twin, target_cost=cost).plan)
