# SPDX-License-Identifier: Apache-2.0
import numpy as np
import physpring
import pytest
from conftest import NODES

pytest.importorskip('scipy')
from physpring.planning import Planner, plan


@pytest.fixture(name='hanging', scope='module')
def fixture_hanging(twin):
    """Where the chain hangs at rest, and its hand."""
    simulator = physpring.Simulator(twin)
    hand = simulator._core.rest_controllers
    position, velocity = simulator.rollout(np.repeat(hand[None], 150, axis=0))
    assert np.abs(velocity[-1]).max() < 0.05
    return position[-1], hand


def end_at(place):
    target = np.full((NODES, 3), np.nan)
    target[-1] = place
    return target


def test_brings_the_end_to_a_place(twin, hanging):
    position, hand = hanging
    goal = position[-1] + [0.15, 0.1, 0.05]
    found = plan(twin, end_at(goal), position=position, controllers=hand, horizon=40, max_speed=0.6)
    assert found.converged
    assert np.linalg.norm(found.position[-1, -1] - goal) < 0.002
    assert found.controllers.shape == (41, 1, 3)
    assert np.array_equal(found.controllers[0], hand)
    speed = np.linalg.norm(np.diff(found.controllers, axis=0), axis=2) * 30
    assert speed.max() <= 0.6 + 1e-9
    # what it says is what happens
    moved = physpring.simulate(twin, found.controllers, position=position)
    assert np.array_equal(moved, found.position)


def test_goes_round_an_obstacle(twin, hanging):
    position, hand = hanging
    goal = position[-1] + [0.2, 0, 0]
    ball = [*(position[-1] + [0.1, 0.01, 0.0]), 0.05]
    straight = plan(twin, end_at(goal), position=position, controllers=hand, horizon=40)
    around = plan(twin, end_at(goal), position=position, controllers=hand, horizon=40, obstacles=[ball])

    def depth(found):
        return (ball[3] - np.linalg.norm(found.position - ball[:3], axis=2)).max()

    assert depth(straight) > 0.03
    assert depth(around) < 0.006
    assert np.linalg.norm(around.position[-1, -1] - goal) < 0.01


def test_gradient_matches_differences(twin, hanging):
    from physpring._plan_search import Search
    position, hand = hanging
    planner = Planner(twin, target_points=end_at(position[-1] + 0.1), horizon=10, knots=3,
                      max_stretch=0.0, obstacles=[[*position[5], 0.05], [*(hand[0] + 0.01), 0.1]])
    search = Search(planner, hand, {'position': position, 'velocity': None}, np.inf, 1000)
    random = np.random.default_rng(0)
    numbers = random.normal(0, 0.5, 9)
    gradient = search.cost(numbers)[1]
    for _ in range(4):
        direction = random.normal(size=9)
        wide, narrow = ((search.cost(numbers + s * direction)[0] -
                         search.cost(numbers - s * direction)[0]) / (2 * s) for s in (2e-4, 1e-4))
        assert gradient @ direction == pytest.approx((4 * narrow - wide) / 3, rel=1e-5)


def test_goes_on_from_what_is_left(twin, hanging):
    position, hand = hanging
    planner = Planner(twin, target_points=end_at(position[-1] + [0.15, 0, 0.1]), horizon=40)
    first = planner.plan(position, hand)
    ahead = planner.replan(first.position[1], first.controllers[1], frames=1, evaluations=1)
    still = np.repeat(first.controllers[1][None], 41, axis=0)
    anew = planner.plan(first.position[1], first.controllers[1], begin_with=still, evaluations=1)
    assert ahead.target_cost < 0.1 * anew.target_cost
    assert planner.plan(position, hand, seconds=0).evaluations <= 4  # its guesses, in any case


def test_takes_a_cost_of_ones_own(twin, hanging):
    position, hand = hanging

    def height(positions):
        bar = np.zeros_like(positions)
        bar[-1, :, 2] = -1 / NODES
        return -positions[-1, :, 2].mean(), bar

    found = plan(twin, target_cost=height, position=position, controllers=hand, horizon=20,
                 max_speed=0.3, evaluations=60)
    rise = found.position[-1, :, 2].mean() - position[:, 2].mean()
    assert rise == pytest.approx(0.3 * 20 / 30, rel=0.1)  # as fast as it may


def test_says_what_is_wrong(twin):
    with pytest.raises(physpring.Error, match='one of target_points and target_cost'):
        plan(twin)
    with pytest.raises(physpring.Error, match='target_points has shape'):
        plan(twin, np.zeros((50, 3)))
    with pytest.raises(physpring.Error, match='max_speed'):
        plan(twin, end_at([0, 0, 0]), max_speed=0)
    with pytest.raises(physpring.Error, match=r'the path has shape \(3, 1, 3\), expected \(31, 1, 3\)'):
        Planner(twin, target_points=end_at([0, 0, 0])).plan(begin_with=np.zeros((3, 1, 3)))
