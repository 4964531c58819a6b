# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_twin.py and phystwin_springs.py: twins move as PhysTwin's models do."""

import unittest

from phystwin_test_case import TwinCase, half_turn, np  # first: it finds the tools, or skips
import phystwin_case_maker as maker
import phystwin_springs


class TwinTest(TwinCase):
    def test_springs_are_searched_as_phystwin_does(self):
        line = np.array([[0, 0, 0], [1.0, 0, 0], [2.1, 0, 0], [3.3, 0, 0], [3.30005, 0, 0]]) / 100
        controllers = np.array([[0.021, 0.01, 0]])
        parameters = {"object_radius": 0.025, "object_max_neighbours": 3,
                      "controller_radius": 0.015, "controller_max_neighbours": 10}
        springs, rest_length, object_springs = phystwin_springs.find_springs(
            line, controllers, parameters)
        # two neighbours each: 0 takes 1, 2; 1 takes 0, 2; 2 takes 1, 3; 3 takes 4, too near to be
        # joined, and 2; 4 takes 3 and 2
        self.assertEqual(springs.tolist(), [[0, 1], [0, 2], [1, 2], [2, 3], [4, 2], [5, 2], [5, 1]])
        self.assertEqual(object_springs, 5)
        np.testing.assert_allclose(
            rest_length, [0.01, 0.021, 0.011, 0.012, 0.0120005, 0.01, np.hypot(0.011, 0.01)])

    def test_twin_moves_as_phystwin(self):
        spring_Y = np.clip(self.write_checkpoint().astype(float), 0, 1e5)
        twin = self.convert_twin("--mass", 0.3)
        count = len(self.particles())
        controllers = half_turn(twin["level0/position"][count:])
        motion, h, steps = np.array([0.01, 0.02, 0.0]), 5e-5, 400

        # PhysTwin: 1 kg a particle, z down, Y (l / L - 1), c = 80, drag = 3
        x = half_turn(twin["level0/position"])
        springs, rest_length = twin["level0/springs"], twin["level0/rest_length"]
        phystwin = self.roll(x, springs, np.ones(count), np.array([0, 0, 9.8]), 3.0, h, steps,
                             lambda l: spring_Y * (l / rest_length - 1),
                             np.where(spring_Y > 0, 80.0, 0), controllers, motion)
        ours = self.roll(twin["level0/position"], springs, twin["level0/mass"], twin["gravity"],
                         twin["level0/drag"], h, steps,
                         lambda l: twin["level0/stiffness"] * (l - rest_length),
                         twin["level0/dashpot"], half_turn(controllers), half_turn(motion))
        self.assertGreater(np.abs(ours - twin["level0/position"][:count]).max(), 1e-4)
        np.testing.assert_allclose(ours, half_turn(phystwin), rtol=0, atol=1e-12)

    @staticmethod
    def roll(x, springs, mass, gravity, drag, h, steps, force, dashpot, controllers, motion):
        """PhysTwin's sub-step with controllers that move but count as at rest; no contact."""
        x, count = np.array(x), len(mass)
        v = np.zeros_like(x)
        a, b = springs.T
        for step in range(steps):
            x[count:] = controllers + motion * (step + 1) / steps
            d = x[b] - x[a]
            length = np.linalg.norm(d, axis=1)
            n = d / length[:, None]
            pull = force(length) + dashpot * ((v[b] - v[a]) * n).sum(axis=1)
            f = np.zeros_like(x)
            np.add.at(f, a, pull[:, None] * n)
            np.add.at(f, b, -pull[:, None] * n)
            v[:count] = (v[:count] + h * (f[:count] / mass[:, None] + gravity)) * np.exp(-h * drag)
            x[:count] += h * v[:count]
        return x[:count]

    def test_stiffness_is_clamped_as_in_phystwin(self):
        self.write_checkpoint()
        twin = self.convert_twin("--mass", 0.61)  # 61 particles of 10 g
        self.assertAlmostEqual(twin["level0/stiffness"][0] * twin["level0/rest_length"][0], 1e3)
        self.assertEqual(twin["level0/stiffness"][1], 0)
        self.assertEqual(twin["level0/dashpot"][1], 0)
        self.assertAlmostEqual(twin["level0/dashpot"][2], 0.8)

    def test_checkpoint_goes_with_whole_numbers(self):
        twin = self.convert_twin("--mass", 0.61)
        self.assertEqual(twin["level0/drag"], 3.75)
        self.assertAlmostEqual(twin["level0/dashpot"][2], 0.805)
        self.assertEqual(self.convert_twin("--truncate")["level0/drag"], 3)
        self.write_checkpoint()
        self.assertEqual(self.convert_twin()["level0/drag"], 3)
        self.assertEqual(self.convert_twin("--no-truncate")["level0/drag"], 3.75)

    def test_contact_coefficients_are_the_checkpoints_within_bounds(self):
        names = ("restitution", "friction", "object_restitution", "object_friction")
        twin = self.convert_twin()
        self.assertEqual([twin["level0/" + name] for name in names], [0.25, 0.75, 0.5, 1.25])
        self.write_checkpoint()
        twin = self.convert_twin()
        self.assertEqual([twin["level0/" + name] for name in names], [1, 0.5, 0.75, 0])

    def test_cloth_collides_with_itself(self):
        self.assertEqual(self.convert_twin()["level0/collision_distance"], 0)
        self.assertEqual(self.convert_twin("--self-collision")["level0/collision_distance"], 0.02)
        cloth = self.folder.with_name("double_lift_cloth")
        self.folder.rename(cloth)
        self.assertEqual(self.convert_twin(folder=cloth)["level0/collision_distance"], 0.02)

    def test_checkpoint_of_another_run_is_refused(self):
        self.write_checkpoint(change=1)
        self.expect_refused("best_180.pth", "springs", "not of one run")

    def test_incomplete_parameters_are_refused(self):
        for change in ({"object_radius": None}, {"drag_damping": -1.0}, {"collide_fric": np.nan}):
            maker.write_pickle(self.folder / "optimal_params.pkl", {**maker.PARAMETERS, **change})
            self.expect_refused("optimal_params.pkl", *change)


if __name__ == "__main__":
    unittest.main()
