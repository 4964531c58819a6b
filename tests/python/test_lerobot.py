# SPDX-License-Identifier: Apache-2.0
"""Policies in Python that are served to tasks, and episodes as LeRobot's data sets. What needs
LeRobot itself is skipped without it (the slow test python_lerobot_test has it)."""
import json
import subprocess
import sys

import numpy as np
import physpring
import pytest

pytest.importorskip('gymnasium')
pytest.importorskip('msgpack')
pytest.importorskip('websockets')
import physpring.envs  # noqa: E402
import physpring.lerobot  # noqa: E402

SMALL = 't_push'  # the task with the shortest episodes at level 3


class Still:
    """A policy that stays where it is, in chunks of 50 actions, and keeps what it was asked."""

    def __init__(self):
        self.requests = []

    def actions(self, request):
        self.requests.append(request)
        return np.tile(request['observation.state'].astype(np.float32), (50, 1))


class Broken:
    def actions(self, request):
        raise ValueError('no such weights')


def test_a_policy_in_python_is_asked_by_lerobots_names():
    policy = Still()
    with physpring.lerobot.PolicyServer(policy) as address:
        report = physpring.sweep(SMALL, address, levels=[3], workers=1,
                                 policy_adapter='lerobot_state').to_dict()
    assert report['policies'][0]['levels'][0]['problems'] == 0
    assert sorted(policy.requests[0]) == ['observation.environment_state', 'observation.state', 'task']
    env = physpring.envs.TaskEnv(SMALL, 3)
    seen, _ = env.reset(seed=0)
    assert np.array_equal(policy.requests[0]['observation.state'], seen['robot'])
    particles = seen['particles'][np.arange(32) * len(seen['particles']) // 32].reshape(-1)
    assert np.array_equal(policy.requests[0]['observation.environment_state'], particles)
    # 20 of 50 actions are executed
    assert len(policy.requests) == -(-env._setting.task.frames // 20)


def test_an_environment_asks_the_same():
    policy = Still()
    env = physpring.envs.TaskEnv(SMALL, 3)
    seen, _ = env.reset(seed=0)
    with physpring.lerobot.PolicyServer(policy) as address:
        action = env.policy_action(address, 'lerobot_state')
    assert np.array_equal(action, seen['robot'].astype(np.float32))


def test_pictures_come_in_the_size_that_is_asked_for():
    policy = Still()
    env = physpring.envs.TaskEnv(SMALL, 3, obs='pixels')
    seen, _ = env.reset(seed=0)
    with physpring.lerobot.PolicyServer(policy) as address:
        env.policy_action(address, 'lerobot_pictures')
    picture = policy.requests[0]['observation.images.front']
    assert picture.shape == (96, 96, 3)
    assert not picture[:12].any() and not picture[84:].any()  # bars: 640 x 480 is 96 x 72
    assert abs(picture[12:84].mean() - seen['pixels']['front'].mean()) < 1


def test_what_goes_wrong_in_a_policy_is_told():
    with physpring.lerobot.PolicyServer(Broken()) as address:
        with pytest.raises(physpring.Error, match="says 'ValueError: no such weights'"):
            physpring.sweep(SMALL, address, levels=[3], workers=1, policy_adapter='lerobot_state')


def test_an_unknown_adapter_is_named():
    with pytest.raises(physpring.Error, match='openpie: is no file, nor one of lerobot_pictures'):
        physpring.sweep(SMALL, 'ws://127.0.0.1:1', policy_adapter='openpie')


def test_looks_vary_with_the_episode_and_motion_does_not():
    plain = physpring.envs.TaskEnv(SMALL, 3, obs='pixels+particles', width=64, height=64)
    varied = physpring.envs.TaskEnv(SMALL, 3, obs='pixels+particles', width=64, height=64,
                                    vary_looks=True)
    pictures = []
    for episode in (0, 1, 0):
        seen = varied.reset(seed=0, options={'episode': episode})[0]
        same = plain.reset(seed=0, options={'episode': episode})[0]
        assert np.array_equal(seen['particles'], same['particles'])
        assert not np.array_equal(seen['pixels']['front'], same['pixels']['front'])
        pictures.append(seen['pixels']['front'])
    assert np.array_equal(pictures[0], pictures[2])
    assert not np.array_equal(pictures[0], pictures[1])


@pytest.fixture(scope='module')
def demos(tmp_path_factory):
    """Three demonstrations with a picture each frame."""
    pytest.importorskip('lerobot')
    folder = tmp_path_factory.mktemp('data') / 'demos'
    made = physpring.lerobot.record(SMALL, folder, 3, level=3, particles=8, cameras=['front'],
                                    size=32, keep='all', vary_looks=True)
    assert made.kept == [0, 1, 2]
    return folder


def test_lerobot_reads_the_demonstrations(demos):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset
    data = LeRobotDataset('physpring/demos', root=demos)
    assert data.meta.info['codebase_version'].startswith('v3')
    env = physpring.envs.TaskEnv(SMALL, 3)
    assert data.num_episodes == 3 and data.num_frames == 3 * env._setting.task.frames
    seen, _ = env.reset(seed=0, options={'episode': 0})
    first = data[0]
    assert np.allclose(first['observation.state'].numpy(), seen['robot'], atol=1e-6)
    assert first['observation.environment_state'].shape == (24,)
    assert tuple(first['observation.images.front'].shape) == (3, 32, 32)
    assert np.allclose(first['action'].numpy(), env.policy_action(), atol=1e-6)
    assert first['task'] == env.prompt


def test_replay_gives_the_verdicts_again(demos):
    for episode in physpring.lerobot.replay(demos):
        assert episode.success == episode.recorded
    with pytest.raises(physpring.Error, match='is there already'):
        physpring.lerobot.record(SMALL, demos, 1, level=3)


def test_lerobot_trains_act_on_them_and_it_is_served(demos, tmp_path):
    """50 steps of LeRobot's own program on its own loader; what comes out runs an episode."""
    out = tmp_path / 'act'
    subprocess.run([sys.executable, '-m', 'lerobot.scripts.lerobot_train',
                    '--dataset.repo_id=physpring/demos', f'--dataset.root={demos}',
                    '--policy.type=act', '--policy.device=cpu', '--policy.push_to_hub=false',
                    '--policy.dim_model=32', '--policy.dim_feedforward=64', '--policy.n_heads=2',
                    '--policy.chunk_size=20', '--policy.n_action_steps=20',
                    '--policy.pretrained_backbone_weights=null', '--batch_size=2', '--steps=50',
                    '--num_workers=0', '--save_freq=50', '--wandb.enable=false',
                    f'--output_dir={out}'], check=True, timeout=900)
    adapter = tmp_path / 'adapter.json'
    adapter.write_text(json.dumps({
        'request': {'observation.state': ['robot'],
                    'observation.environment_state': [{'part': 'particles', 'count': 8}],
                    'observation.images.front': {'camera': 'front', 'size': [32, 32]}},
        'action': ['robot']}))
    policy = physpring.lerobot.LeRobotPolicy(out / 'checkpoints/last/pretrained_model')
    with physpring.lerobot.PolicyServer(policy) as address:
        report = physpring.sweep(SMALL, address, levels=[3], workers=1,
                                 policy_adapter=adapter).to_dict()
    episode = report['policies'][0]['episodes'][0]
    assert episode['problem'] in ('',) or 'quaternion' in episode['problem']
