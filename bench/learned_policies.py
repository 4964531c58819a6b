#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tables 5 and 6 of the paper with policies that are learned here: learned_policies.py OUTPUT

For rope routing and cloth folding: demonstrations of the scripted policy at level 0 as a data set of
LeRobot; ACT, LeRobot's, trained on their states; snapshots of it at several iterations; each served
by physpring.lerobot and judged at levels 0 to 3, on the same starts, which are not those of the
demonstrations. Then the A/A control at level 0, and the actions sampled a second.

A run that was stopped goes on. Needs an environment with physpring[envs], lerobot, msgpack and
websockets. The tables are in OUTPUT/tables.md, figures in OUTPUT/TASK/report.json.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import physpring
import physpring.lerobot

TASKS = {  # iterations of the snapshots
    'rope_routing': (200, 400, 700, 1200, 2400),
    'cloth_folding': (100, 200, 400, 1000, 3000),
}
# Noise of the particles' positions in training, m, along each axis: what a coarse level's finer
# wrinkles change of what is seen must not matter to a policy.
NOISE = {'rope_routing': 0, 'cloth_folding': 5e-3}
LEVELS = '0,1,2,3'
DEMOS, DEMO_SEED, SEED = 100, 100, 1
CHUNK, WIDTH, BATCH, RATE = 40, 192, 64, 2e-4
PARTICLES = 32
PROGRAM = pathlib.Path(sys.executable).parent / 'physpring'
ADAPTER = pathlib.Path(__file__).resolve().parents[1] / 'models/adapters/lerobot_state.json'


def timed(folder, name, work):
    """Runs what is not done yet and keeps its seconds."""
    done = folder / f'{name}.seconds'
    if done.exists():
        return
    start = time.monotonic()
    work()
    done.write_text(f'{time.monotonic() - start:.0f}\n')


def train(dataset, output, snapshots, noise):
    """ACT on states, without its variational part: the demonstrations of a script have one style.
    `noise`: of the particles' positions, m."""
    import torch
    from lerobot.configs.types import FeatureType, NormalizationMode, PolicyFeature
    from lerobot.datasets.lerobot_dataset import LeRobotDataset
    from lerobot.policies.act.configuration_act import ACTConfig
    from lerobot.policies.act.modeling_act import ACTPolicy
    from lerobot.policies.factory import make_pre_post_processors
    torch.manual_seed(0)
    torch.set_num_threads(2)
    data = LeRobotDataset('physpring/demos', root=dataset)
    table = data.hf_dataset.with_format('numpy')
    column = {key: torch.tensor(np.asarray(table[key][:], np.float32)) for key in
              ('observation.state', 'observation.environment_state', 'action')}
    episode = np.asarray(table['episode_index'][:])
    ends = torch.tensor(np.searchsorted(episode, episode, side='right'))
    stats = {key: {'mean': values.mean(0), 'std': values.std(0).clamp(min=1e-3)}
             for key, values in column.items()}
    kinds = {'observation.state': FeatureType.STATE, 'observation.environment_state': FeatureType.ENV,
             'action': FeatureType.ACTION}
    feature = {key: PolicyFeature(kind, (column[key].shape[1],)) for key, kind in kinds.items()}
    config = ACTConfig(
        output_features={'action': feature.pop('action')}, input_features=feature,
        chunk_size=CHUNK, n_action_steps=CHUNK, dim_model=WIDTH, n_heads=4, dim_feedforward=4 * WIDTH,
        n_encoder_layers=3, use_vae=False, device='cpu', optimizer_lr=RATE,
        normalization_mapping=dict.fromkeys(('STATE', 'ENV', 'ACTION'), NormalizationMode.MEAN_STD))
    policy = ACTPolicy(config)
    processors = make_pre_post_processors(config, dataset_stats=stats)
    optimizer = torch.optim.AdamW(policy.parameters(), lr=RATE, weight_decay=1e-4)
    scaled = {key: (values - stats[key]['mean']) / stats[key]['std']
              for key, values in column.items()}
    places = 'observation.environment_state'
    generator = torch.Generator().manual_seed(0)
    policy.train()
    last = max(snapshots)
    for step in range(1, last + 1):
        decay = 1 if step <= last / 2 else 0.5 * (1 + np.cos(np.pi * step / last))
        for group in optimizer.param_groups:
            group['lr'] = RATE * min(1, step / 200) * decay
        rows = torch.randint(len(episode), (BATCH,), generator=generator)
        ahead = rows[:, None] + torch.arange(CHUNK)
        pad = ahead >= ends[rows][:, None]
        ahead = torch.minimum(ahead, ends[rows][:, None] - 1)
        batch = {key: scaled[key][rows] for key in feature}
        if noise > 0:
            batch[places] = batch[places] + noise / stats[places]['std'] * torch.randn(
                batch[places].shape, generator=generator)
        loss, parts = policy.forward({**batch, 'action': scaled['action'][ahead],
                                      'action_is_pad': pad})
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(policy.parameters(), 10)
        optimizer.step()
        if step % 100 == 0:
            print(f'  step {step} of {last}, L1 {parts["l1_loss"]:.4f}', flush=True)
        if step in snapshots:
            for part in (policy, *processors):
                part.save_pretrained(output / f'{step:06d}')


def sweeps(task, folder, arguments):
    """A folder of episodes for each snapshot."""
    for snapshot in TASKS[task]:
        out = episodes(folder, snapshot)
        timed(folder, f'sweep_{snapshot:06d}', lambda: rollout_kept(task, folder, snapshot, out,
                                                                    arguments, '--level', LEVELS))
    judged = merged(*(episodes(folder, snapshot) for snapshot in TASKS[task]))['policies']
    _, best = max((rates_of(policy)[0], snapshot) for snapshot, policy in zip(TASKS[task], judged))
    out = folder / 'control'
    timed(folder, 'control', lambda: rollout_kept(task, folder, best, out, arguments, '--level', '0',
                                                  '--perturb', '1e-6'))
    return best


def rollout_kept(task, folder, snapshot, out, arguments, *options):
    """`physpring rollout` of this environment against a server of the snapshot. The address is part
    of what a sweep is, so the port is always the same."""
    policy = physpring.lerobot.LeRobotPolicy(folder / 'act' / f'{snapshot:06d}')
    with (physpring.lerobot.PolicyServer(policy, port=arguments.port),
          open(folder / 'rollout.log', 'a') as log):
        subprocess.run([PROGRAM, 'rollout', scene(task),
                        '--policy', f'ws://127.0.0.1:{arguments.port}/{snapshot}',
                        '--policy-adapter', ADAPTER, '--seed', str(SEED), '--threads', '2',
                        '--episodes', str(arguments.episodes), '--states', 'actions', '-o', out,
                        *options], check=True, stderr=log)


def episodes(folder, snapshot):
    return folder / 'episodes' / f'{snapshot:06d}'


def scene(task):
    return ADAPTER.parents[1] / 'scenes' / task


def merged(*folders):
    """The report of `physpring merge`: successes, agreements, MMRV and Pearson's correlation."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / 'report.json'
        subprocess.run([PROGRAM, 'merge', *folders, '--json', path], check=True,
                       stdout=subprocess.DEVNULL)
        return json.loads(path.read_text())


def rates_of(policy):
    """Share of successes by level."""
    return {level['level']: level['rate'] for level in policy['levels']}


def agreements_of(policy):
    """Share of the episodes with level 0's verdict, by level."""
    return {one['level']: one['agreement'] for one in policy['comparisons']}


def speeds(task, folder, best):
    """Actions sampled a second at each level, on one thread, levels in turn."""
    out = folder / 'speed.json'
    if out.exists():
        return json.loads(out.read_text())
    policy = physpring.lerobot.LeRobotPolicy(folder / 'act' / f'{best:06d}')
    found = {level: [] for level in LEVELS.split(',')}
    with physpring.lerobot.PolicyServer(policy) as address:
        for repeat in range(3):
            for level, rates in found.items():
                report = folder / 'speed_report.json'
                subprocess.run([PROGRAM, 'rollout',
                                scene(task), '--policy', address, '--policy-adapter', ADAPTER,
                                '--level', level, '--episodes', '3', '--first', str(3 * repeat),
                                '--json', report], check=True, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
                kept = json.loads(report.read_text())['policies'][0]['levels'][0]
                rates.append(kept['frames_per_second'])
    out.write_text(json.dumps(found))
    return found


def report(task, folder, best):
    snapshots, levels = TASKS[task], [int(level) for level in LEVELS.split(',')]
    found = merged(*(episodes(folder, snapshot) for snapshot in snapshots))
    control = merged(episodes(folder, best), folder / 'control')
    speed = {int(level): float(np.median(rates)) for level, rates in
             speeds(task, folder, best).items()}
    found.update(best=best, control=control['policy_comparisons'], speed=speed,
                 seconds={path.stem: int(path.read_text())
                          for path in sorted(folder.glob('*.seconds'))})
    (folder / 'report.json').write_text(json.dumps(found, indent=1) + '\n')
    count = found['policies'][0]['levels'][0]['episodes']
    lines = [f'\n**{task}**, successes of {count}\n', '| iteration | level 0 | 1 | 2 | 3 |',
             '|---|---|---|---|---|']
    for snapshot, policy in zip(snapshots, found['policies']):
        rates = rates_of(policy)
        lines.append(f'| {snapshot} | '
                     + ' | '.join(f'{rates[level] * count:.0f}' for level in levels) + ' |')
    lines += ['', '| level | agrees with level 0 (best snapshot) | all snapshots | Pearson | MMRV | '
              'actions/s | x level 0 |', '|---|---|---|---|---|---|---|',
              f'| 0 | {100 * control["policy_comparisons"][0]["agreement"]:.0f} % (A/A) | | | | '
              f'{speed[0]:.0f} | 1.00 |']
    agreements = [agreements_of(policy) for policy in found['policies']]
    for ranking in found['rankings']:
        level = ranking['level']
        at_best = agreements[snapshots.index(best)][level]
        lines.append(f'| {level} | {100 * at_best:.0f} % | '
                     f'{100 * np.mean([one[level] for one in agreements]):.0f} % | '
                     f'{ranking["pearson"]:.3f} | {ranking["mmrv"]:.3f} | {speed[level]:.0f} | '
                     f'{speed[level] / speed[0]:.2f} |')
    return '\n'.join(lines) + '\n'


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('output', type=pathlib.Path)
    parser.add_argument('--episodes', type=int, default=100)
    parser.add_argument('--port', type=int, default=8765)
    parser.add_argument('--tasks', default=','.join(TASKS))
    arguments = parser.parse_args()
    os.environ.setdefault('HF_HUB_OFFLINE', '1')
    text = ''
    for task in arguments.tasks.split(','):
        folder = arguments.output / task
        folder.mkdir(parents=True, exist_ok=True)
        print(f'{task}: demonstrations', flush=True)
        timed(folder, 'demonstrations', lambda: physpring.lerobot.record(
            scene(task), folder / 'demos', DEMOS, seed=DEMO_SEED, particles=PARTICLES))
        print(f'{task}: ACT', flush=True)
        timed(folder, 'training', lambda: train(folder / 'demos', folder / 'act', TASKS[task],
                                                NOISE[task]))
        print(f'{task}: episodes', flush=True)
        best = sweeps(task, folder, arguments)
        text += report(task, folder, best)
        (arguments.output / 'tables.md').write_text(text)
    print(text)


if __name__ == '__main__':
    main()
