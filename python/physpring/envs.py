# SPDX-License-Identifier: Apache-2.0
"""The tasks of PhySPRING as environments of Gymnasium.

    import gymnasium
    import physpring.envs
    env = gymnasium.make('physpring/RopeRouting-v0', level=3)
    observation, info = env.reset(seed=0)
    observation, reward, terminated, truncated, info = env.step(env.action_space.sample())

The same code steps an episode here and in `physpring rollout`: states, verdicts and pictures are
the same. Needs the extra `envs`: pip install 'physpring[envs]'.
"""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array
from numpy.typing import NDArray

from physpring import _core
from physpring._mujoco import adapter_file, scenes, task_folder
from physpring._recordings import number, seed_of, threads_of, whole
from physpring._simulation import _doubles
from physpring._warnings import warn

TASKS = {'RopeRouting': 'rope_routing', 'ToyPacking': 'toy_packing', 'TPush': 't_push',
         'ClothFolding': 'cloth_folding'}
_REACH = 3.0  # m: bounds of a sampled place; the robot's speed limits what it does
_FAR = 1e3  # m: what is farther off has diverged


class _Setting:
    """A task at one level, and what its observations and actions are."""

    def __init__(self, task: str | os.PathLike, level: int, obs: str, width: int, height: int,
                 quality: str, vary_looks: bool, sample: str | os.PathLike):
        kinds = {'particles', 'nodes', 'pixels', 'sensors'}
        if not obs or not kinds.issuperset(obs.split('+')):
            raise _core.Error(f'obs is {obs!r}, expected some of {", ".join(sorted(kinds))}, '
                              "as 'pixels+particles'")
        whole('level', level, 0)
        whole('width', width, 0, 8192)
        whole('height', height, 0, 8192)
        self.task = scenes().Task.load(os.fspath(task_folder(task)), level, quality, width, height,
                                       vary_looks, os.fspath(sample))
        warn(self.task.warnings)
        self.seen = obs.split('+')
        self.observation_space = self._observations()
        self.action_space = self._actions()

    def _observations(self) -> spaces.Dict:
        task = self.task
        parts: dict[str, spaces.Space] = {
            'robot': spaces.Box(-_FAR, _FAR, (task.robot_size,), np.float64)
        }
        for name, count in (('particles', task.particle_count), ('nodes', task.node_count)):
            if name in self.seen:
                parts[name] = spaces.Box(-_FAR, _FAR, (count, 3), np.float64)
        if 'pixels' in self.seen:
            picture = spaces.Box(0, 255, (task.height, task.width, 3), np.uint8)
            parts['pixels'] = spaces.Dict({camera: picture for camera in task.cameras})
        if 'sensors' in self.seen:
            parts['sensors'] = spaces.Dict({
                name: spaces.Box(-np.inf, np.inf, (size,), np.float64)
                for name, size in task.sensors
            })
        return spaces.Dict(parts)

    def _actions(self) -> spaces.Box:
        if self.task.cartesian:
            most = np.array([_REACH] * 3 + [1.0] * 5)
            least = -most
            least[7] = 0
            return spaces.Box(least, most, dtype=np.float64)
        ends = self.task.control_range.reshape(-1, 2)
        return spaces.Box(ends[:, 0], ends[:, 1], dtype=np.float64)

    def observe(self, scene: Any) -> dict[str, Any]:
        seen: dict[str, Any] = {'robot': scene.robot}
        if 'particles' in self.seen:
            seen['particles'] = scene.particles
        if 'nodes' in self.seen:
            seen['nodes'] = scene.nodes
        if 'pixels' in self.seen:
            seen['pixels'] = scene.look()
        if 'sensors' in self.seen:
            seen['sensors'] = scene.sensors
        return seen

    @staticmethod
    def inform(scene: Any) -> dict[str, Any]:
        return {'value': scene.value, 'met_frames': scene.met_frames, 'is_success': scene.success}


class _Episodes:
    """The numbers of an environment's episodes: one after the other, as in `physpring rollout`, or in
    random cells of the task's grid."""

    def __init__(self, setting: _Setting, one_after_the_other: bool):
        self.seed, self._next = 0, 0
        self._random_of = None if one_after_the_other else 1000 * setting.task.cells

    def begin(self, seed: int) -> None:
        self.seed, self._next = seed, 0

    def next(self, wished: int | None = None) -> int:
        episode = self._next if wished is None else whole('episode', wished, 0)
        self._next = episode + 1
        if wished is not None or self._random_of is None:
            return episode
        return int(np.random.default_rng((self.seed, episode)).integers(self._random_of))


class TaskEnv(gymnasium.Env):
    """A task at one level of its twin.

    task: the name of a task of this package ('rope_routing', 'toy_packing', 't_push',
        'cloth_folding'), or a folder with a task.json (docs/rollout.md).
    level: of the twin, 0 (dense) to 3.
    obs: what an observation has besides `robot`, the robot's state: 'particles' (N, 3), the
        particles of level 0 [m], lifted from the level that is simulated, so that one policy serves
        all levels; 'nodes', those of the level; 'pixels', a picture of each camera; 'sensors', what
        the task's `sensors` read, as forces of contact; or several, as 'pixels+particles'.
    width, height: of pictures, pixels; default: the task's. quality: 'fast' or 'high'.
    action_noise: m, standard deviation of an error of the hand's x and y, constant in an episode.
    start_noise: m, by which the object lies elsewhere, in a random direction.
    cells: whether episodes start in the cells of the task's grid one after the other, as in
        `physpring rollout`; else in random ones.
    vary_looks: whether each episode has other colours, lights and places of cameras, by its seed.
    sample: folder with the level of another twin of the same nodes, as one of those that
        `physpring export --samples N --springs plugin --controllers none` writes; '': the task's.

    Actions: x y z [m], the quaternion w x y z of the hand and the gripper (0 open, 1 closed), all
    absolute; or the controls of joints. The reward is 1 in a frame in which the task's rule is met,
    else 0; info has `is_success`, whether that happened often enough, and the rule's `value`. An
    episode ends (truncated) after the task's frames. An action that cannot be followed raises
    physpring.Error and changes nothing.

    reset(seed=s) begins episode 0 of `physpring rollout --seed s`, later resets the next ones.
    reset(options={'episode': k}) begins episode k; {'position': .., 'quaternion': ..} puts the
    object there.
    """
    metadata: dict[str, Any] = {'render_modes': ['rgb_array'], 'render_fps': 30}

    def __init__(self,
                 task: str | os.PathLike,
                 level: int = 0,
                 *,
                 obs: str = 'particles',
                 width: int = 0,
                 height: int = 0,
                 quality: str = 'fast',
                 action_noise: float = 0,
                 start_noise: float = 0,
                 cells: bool = True,
                 vary_looks: bool = False,
                 sample: str | os.PathLike = '',
                 render_mode: str | None = None):
        if render_mode not in (None, 'rgb_array'):
            raise _core.Error(f"render_mode is {render_mode!r}, expected None or 'rgb_array'")
        self._setting = _Setting(task, level, obs, width, height, quality, vary_looks, sample)
        self._scene = scenes().Scene(self._setting.task)
        self._noise = _noise(action_noise, start_noise)
        self._episodes = _Episodes(self._setting, cells)
        self.render_mode = render_mode
        self.observation_space = self._setting.observation_space
        self.action_space = self._setting.action_space
        self.prompt: str = self._setting.task.prompt

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        if seed is not None:
            self._episodes.begin(seed)
        options = options or {}
        unknown = set(options) - {'episode', 'position', 'quaternion'}
        if 'quaternion' in options and 'position' not in options:
            raise _core.Error('quaternion needs position: where the object starts')
        if unknown:
            raise _core.Error(f'reset knows no option {min(unknown)!r}; there are episode, '
                              'position, quaternion')
        if 'position' in options:
            self._scene.reset_at(np.asarray(options['position'], float),
                                 np.asarray(options.get('quaternion', (1, 0, 0, 0)), float),
                                 self._episodes.seed)
        else:
            episode = self._episodes.next(options.get('episode'))
            self._scene.reset(self._episodes.seed, episode, *self._noise)
        return self._setting.observe(self._scene), self._inform()

    def _inform(self) -> dict[str, Any]:
        return {**self._setting.inform(self._scene), 'episode': self._scene.start[0]}

    def step(self, action: NDArray[np.float64]) -> Any:
        self._scene.step(_action(action))
        reward = 1.0 if self._scene.met else 0.0
        return (self._setting.observe(self._scene), reward, False, self._scene.over, self._inform())

    def policy_action(self, policy: str = 'scripted',
                      policy_adapter: str | os.PathLike = '') -> NDArray[np.float64]:
        """What a policy of `physpring rollout` does now: 'scripted' (the task's own), 'random',
        'replay:PATH', or 'ws://HOST:PORT', spoken to by `policy_adapter` (as in
        physpring.sweep)."""
        return self._scene.act(policy, adapter_file(policy_adapter))

    def render(self) -> Any:
        if self.render_mode is None:
            return None
        pictures = self._scene.look()
        return pictures[self._setting.task.cameras[0]]


class TaskVectorEnv(gymnasium.vector.VectorEnv):
    """Many environments of one task, stepped side by side on threads of this process. Arguments are
    those of TaskEnv; `threads`: at most so many, None: all cores. After an episode has ended, the
    next step begins the next one (AutoresetMode.NEXT_STEP)."""
    metadata: dict[str, Any] = {'render_modes': [],
                'render_fps': 30,
                'autoreset_mode': gymnasium.vector.AutoresetMode.NEXT_STEP}

    def __init__(self,
                 num_envs: int,
                 task: str | os.PathLike,
                 level: int = 0,
                 *,
                 obs: str = 'particles',
                 width: int = 0,
                 height: int = 0,
                 quality: str = 'fast',
                 action_noise: float = 0,
                 start_noise: float = 0,
                 cells: bool = True,
                 vary_looks: bool = False,
                 sample: str | os.PathLike = '',
                 threads: int | None = None,
                 render_mode: str | None = None):
        if render_mode is not None:
            raise _core.Error('a vector of environments has no render_mode')
        self._setting = _Setting(task, level, obs, width, height, quality, vary_looks, sample)
        whole('num_envs', num_envs, 1)
        self._scenes = [scenes().Scene(self._setting.task) for _ in range(num_envs)]
        self._noise = _noise(action_noise, start_noise)
        self._threads = threads_of(threads)
        self.num_envs = num_envs
        self.single_observation_space = self._setting.observation_space
        self.single_action_space = self._setting.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.render_mode = None
        self._episodes = [_Episodes(self._setting, cells) for _ in range(num_envs)]
        self._ended = np.zeros(num_envs, bool)

    def reset(self, *, seed: int | Sequence[int | None] | None = None,
              options: dict[str, Any] | None = None) -> Any:
        options = options or {}
        if set(options) - {'reset_mask'}:
            raise _core.Error(f'reset knows no option {min(set(options) - {"reset_mask"})!r}; there is '
                              'reset_mask')
        mask = np.asarray(options.get('reset_mask', np.ones(self.num_envs, bool)), bool)
        if seed is not None and not isinstance(seed, (Sequence, np.ndarray)):
            seed = [seed_of(seed) + i for i in range(self.num_envs)]
        if mask.shape != (self.num_envs,) or (seed is not None and len(seed) != self.num_envs):
            raise _core.Error(f'reset_mask and seed have one entry for each of {self.num_envs} '
                              'environments')
        for i, one in enumerate(seed or ()):
            if one is not None and mask[i]:
                self._episodes[i].begin(int(one))
        self._begin(np.flatnonzero(mask))
        self._ended[mask] = False
        return self._observe(), self._inform()

    def _begin(self, which: Any) -> None:
        """The next episode of some of them."""
        which = [int(i) for i in which]
        episodes = [self._episodes[i] for i in which]
        scenes().reset_all([self._scenes[i] for i in which], [one.seed for one in episodes],
                           [one.next() for one in episodes], *self._noise, self._threads)

    def step(self, actions: NDArray[np.float64]) -> Any:
        actions = _doubles('actions', actions, 2)
        if actions.shape != self.action_space.shape:
            raise _core.Error(
                f'actions has shape {actions.shape}, expected {self.action_space.shape}')
        anew, on = np.flatnonzero(self._ended), np.flatnonzero(~self._ended)
        scenes().step_all([self._scenes[i] for i in on], actions[on], self._threads)
        if anew.size > 0:
            self._begin(anew)
        rewards = np.array([float(not ended and scene.met)
                            for scene, ended in zip(self._scenes, self._ended)])
        self._ended = np.array([scene.over for scene in self._scenes])
        return (self._observe(), rewards, np.zeros(self.num_envs, bool), self._ended.copy(),
                self._inform())

    def _observe(self) -> Any:
        seen = [self._setting.observe(scene) for scene in self._scenes]
        together: Any = create_empty_array(self.single_observation_space, self.num_envs)
        return concatenate(self.single_observation_space, seen, together)

    def _inform(self) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        for i, scene in enumerate(self._scenes):
            infos = self._add_info(infos, self._setting.inform(scene), i)
        return infos

    def policy_actions(self, policy: str = 'scripted') -> NDArray[np.float64]:
        """What a policy of `physpring rollout` does now in each of them."""
        return np.array([scene.act(policy) for scene in self._scenes])


def _action(action: Any) -> NDArray[np.float64]:
    return _doubles('an action', action, 1)


def _noise(action_noise: float, start_noise: float) -> tuple[float, float]:
    return number('action_noise', action_noise, 0, 1), number('start_noise', start_noise, 0, 1)


def register() -> None:
    """Makes 'physpring/RopeRouting-v0' and the others known to Gymnasium. Importing this does."""
    for name, task in TASKS.items():
        key = f'physpring/{name}-v0'
        if key not in gymnasium.registry:
            gymnasium.register(key, entry_point='physpring.envs:TaskEnv',
                               vector_entry_point='physpring.envs:TaskVectorEnv',
                               kwargs={'task': task})


register()
