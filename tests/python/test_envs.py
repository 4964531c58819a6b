# SPDX-License-Identifier: Apache-2.0
import json
import shutil
import warnings

import numpy as np
import physpring
import pytest
from conftest import run_program
from physpring._mujoco import task_folder

gymnasium = pytest.importorskip('gymnasium')
pytest.importorskip('mujoco')
import physpring.envs
from gymnasium.utils import env_checker

NAMES = list(physpring.envs.TASKS)


@pytest.mark.parametrize('name', NAMES)
def test_passes_the_checks_of_gymnasium(name):
    env = gymnasium.make(f'physpring/{name}-v0', level=3, render_mode='rgb_array', width=64, height=48)
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        # states are where things are, so no bounds of 1
        warnings.filterwarnings('ignore', message='.*(greater than|less than).*')
        warnings.filterwarnings('ignore', message='.*normalized.*')
        env_checker.check_env(env.unwrapped)
    if hasattr(env_checker, 'check_vector_env'):
        vector = gymnasium.make_vec(f'physpring/{name}-v0', 3, level=3,
                                    vectorization_mode='vector_entry_point')
        env_checker.check_vector_env(vector)


@pytest.mark.parametrize('name', NAMES)
@pytest.mark.parametrize('level', [0, 3])
def test_is_the_runners(name, level, tmp_path):
    if level == 0 and name != 'RopeRouting':
        pytest.skip('takes long')
    folder = task_folder(physpring.envs.TASKS[name])
    run_program('rollout', folder, '--level', level, '--episodes', 2, '--seed', 5, '--action-noise',
                0.02, '-o', tmp_path)
    env = gymnasium.make(f'physpring/{name}-v0', level=level, obs='nodes', action_noise=0.02)
    for episode in range(2):
        observation, info = env.reset(seed=5 if episode == 0 else None)
        assert info['episode'] == episode
        robot, nodes, rewards, done = [observation['robot']], [observation['nodes']], [], False
        while not done:
            observation, reward, terminated, done, info = env.step(env.unwrapped.policy_action())
            assert not terminated
            robot.append(observation['robot'])
            nodes.append(observation['nodes'])
            rewards.append(reward)
        kept = tmp_path / f'level{level}' / f'episode_{episode:05}'
        verdict = json.loads(kept.with_suffix('.json').read_text())
        assert info['is_success'] == verdict['success']
        assert info['met_frames'] == verdict['met_frames'] == sum(rewards)
        with np.load(kept.with_suffix('.npz')) as states:
            assert np.array_equal(states['robot'], np.array(robot))
            assert np.array_equal(states['nodes'], np.array(nodes))


def test_episodes_repeat(tmp_path):
    env = gymnasium.make('physpring/TPush-v0', level=3)
    random = np.random.default_rng(0)
    actions = [env.action_space.sample() for _ in range(3)] + [random.uniform(-0.5, 0.5, 8)]

    def run(**reset):
        seen = [env.reset(**reset)[0]]
        seen += [env.step(action)[0] for action in actions]
        return np.array([one['particles'] for one in seen])

    first, second = run(seed=3), run()
    assert not np.array_equal(first, second)
    assert np.array_equal(run(seed=3), first)
    assert np.array_equal(run(), second)
    assert np.array_equal(run(options={'episode': 1}), second)
    place = {'position': [0.1, 0.05, 0.02], 'quaternion': [1, 0, 0, 0]}
    assert np.array_equal(run(options=place), run(options=place))


def test_level_0_sees_what_level_3_does():
    shapes = [gymnasium.make('physpring/ClothFolding-v0', level=level).observation_space['particles'].shape
              for level in (0, 3)]
    assert shapes[0] == shapes[1]


def test_bad_actions_are_refused_and_change_nothing():
    env = gymnasium.make('physpring/TPush-v0', level=3).unwrapped
    good = np.array([0, 0, 0.3, 1, 0, 0, 0, 0.0])
    with pytest.raises(physpring.Error, match='reset'):
        env.step(good)
    env.reset(seed=0)
    expected = env.step(good)[0]
    env.reset(seed=0)
    for bad, why in ((good[:7], 'has 7 numbers, expected 8'), (good * np.nan, 'not finite'),
                     (good * [1, 1, 1, 0, 0, 0, 0, 1], 'quaternion'), (good[None], '1 dimension'), (good + 1j, 'complex')):
        with pytest.raises(physpring.Error, match=why):
            env.step(bad)
    assert np.array_equal(env.step(good)[0]['particles'], expected['particles'])
    with pytest.raises(physpring.Error, match="obs is 'sound'"):
        gymnasium.make('physpring/TPush-v0', obs='sound')
    with pytest.raises(physpring.Error, match='nowhere'):
        physpring.envs.TaskEnv('nowhere')


def test_pictures_are_those_of_a_policy_server():
    env = gymnasium.make('physpring/RopeRouting-v0', level=3, obs='pixels', render_mode='rgb_array')
    observation, _ = env.reset(seed=0)
    picture = next(iter(observation['pixels'].values()))
    assert picture.shape == (480, 640, 3)
    assert picture.std() > 10
    assert np.array_equal(env.render(), picture)
    small = physpring.envs.TaskEnv('rope_routing', 3, obs='pixels+particles', width=96, height=96)
    observation, _ = small.reset(seed=0)
    assert all(one.shape == (96, 96, 3) for one in observation['pixels'].values())
    assert small.observation_space.contains(observation)


@pytest.mark.parametrize('mode', ['async', 'vector_entry_point'])
def test_vectors_are_single_ones(mode):
    vector = gymnasium.make_vec('physpring/TPush-v0', 3, level=3, vectorization_mode=mode)
    one = gymnasium.make('physpring/TPush-v0', level=3)
    seen, _ = vector.reset(seed=[4, 9, 4])
    action = np.array([0.1, 0, 0.2, 1, 0, 0, 0, 0.5])
    many = [seen['particles']] + [vector.step(np.tile(action, (3, 1)))[0]['particles'] for _ in range(4)]
    for place, seed in enumerate([4, 9, 4]):
        single = [one.reset(seed=seed)[0]['particles']] + [one.step(action)[0]['particles']
                                                          for _ in range(4)]
        assert np.array_equal(np.array(many)[:, place], np.array(single))
    vector.close()


def test_vector_goes_on_after_an_episode():
    vector = physpring.envs.TaskVectorEnv(2, 't_push', 3)
    vector.reset(seed=[0, 0])
    single = physpring.envs.TaskEnv('t_push', 3)
    single.reset(seed=0)
    frames = vector._setting.task.frames
    for frame in range(frames):
        _, _, _, ended, _ = vector.step(vector.policy_actions())
        assert ended.all() == (frame == frames - 1)
    seen, rewards, _, ended, _ = vector.step(np.zeros((2, 8)))  # is not used: the next one begins
    assert not ended.any() and not rewards.any()
    expected = single.reset()[0]
    assert np.array_equal(seen['particles'][1], expected['particles'])


def test_random_cells_are_the_same_in_vectors():
    single = physpring.envs.TaskEnv('t_push', 3, cells=False)
    vector = physpring.envs.TaskVectorEnv(2, 't_push', 3, cells=False)
    seen, _ = vector.reset(seed=[3, 4])
    episodes = []
    for place, seed in enumerate([3, 4]):
        alone, info = single.reset(seed=seed)
        assert np.array_equal(seen['particles'][place], alone['particles'])
        episodes.append(info['episode'])
    assert episodes[0] != episodes[1]


def test_tells_warnings_of_the_task(tmp_path):
    packaged, task = task_folder('rope_routing'), tmp_path / 'task'
    shutil.copytree(packaged, task)
    for shared in packaged.parent.glob('*.xml'):
        shutil.copy(shared, tmp_path)
    columns = ('x', 'y', 'z', 'f_dc_0', 'f_dc_1', 'f_dc_2', 'opacity', 'scale_0', 'scale_1', 'scale_2',
               'rot_0', 'rot_1', 'rot_2', 'rot_3')
    header = ['ply', 'format binary_little_endian 1.0', 'element vertex 1',
              *(f'property float {name}' for name in columns), 'end_header', '']
    far = np.array([9, 9, 9, 0, 0, 0, 0, -5, -5, -5, 1, 0, 0, 0], '<f4')
    (task / 'far.ply').write_bytes('\n'.join(header).encode() + far.tobytes())
    words = json.loads((task / 'task.json').read_text())
    (task / 'task.json').write_text(json.dumps({**words, 'splats': {'file': 'far.ply'}}))
    with pytest.warns(physpring.PhyspringWarning, match='far.ply'):
        gymnasium.make('physpring/RopeRouting-v0', task=task, level=3)
    with pytest.warns(physpring.PhyspringWarning, match='far.ply'):
        physpring.sweep(task, 'random', levels=[3], workers=1)
