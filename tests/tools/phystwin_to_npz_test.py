# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_to_npz.py. PHYSPRING, where set, is the program that reads its output."""

import contextlib
import io
import json
import os
import pickle
import subprocess
import unittest

from phystwin_test_case import Case, half_turn, np  # first: it finds the tools, or skips
import phystwin_case_maker as maker
import phystwin_springs
import phystwin_to_npz
import safe_pickle


class RecordingTest(Case):
    def test_points_are_seen_where_visible_and_followed(self):
        maker.write_case(self.folder, self.data)
        points = self.convert()["points"]
        for t, i in np.ndindex(points.shape[:2]):
            followed = self.data["object_visibilities"][t, i] and (
                t == 0 or self.data["object_motions_valid"][t - 1, i])
            if followed:
                np.testing.assert_array_equal(points[t, i],
                                              half_turn(self.data["object_points"][t, i]))
            else:
                self.assertTrue(np.isnan(points[t, i]).all())

    def test_surface_holds_all_that_is_visible(self):
        maker.write_case(self.folder, self.data)
        surface = self.convert()["surface"]
        visible = self.data["object_visibilities"]
        np.testing.assert_array_equal(np.isnan(surface).any(axis=2), ~visible)
        np.testing.assert_array_equal(surface[visible],
                                      half_turn(self.data["object_points"][visible]))

    def test_interior_is_surface_points_then_interior_points(self):
        maker.write_case(self.folder, self.data)
        expected = np.concatenate([self.data["surface_points"], self.data["interior_points"]])
        np.testing.assert_allclose(self.convert()["interior"], half_turn(expected), rtol=1e-6)

    def test_height_is_above_the_ground_and_the_frame_right_handed(self):
        maker.write_case(self.folder, self.data)
        recording = self.convert()
        np.testing.assert_array_equal(recording["ground"], [0, 0, 1, 0])
        np.testing.assert_array_equal(recording["gravity"], [0, 0, -9.8])
        self.assertTrue((recording["controllers"][..., 2] > 0).all())
        before, after = self.data["object_points"][0, :4], recording["points"][0, :4]
        volume = np.linalg.det(before[1:] - before[0])
        self.assertAlmostEqual(np.linalg.det(after[1:] - after[0]) / volume, 1, places=5)

    def test_split_and_track_are_taken_over(self):
        track = np.full((6, 2, 3), 0.5)
        track[3, 1, 0] = np.nan
        maker.write_case(self.folder, self.data, split=(0, 5), track=track)
        recording = self.convert()
        self.assertEqual(recording["train_frames"], 5)
        np.testing.assert_array_equal(recording["track"][3, 0], [0.5, -0.5, -0.5])
        self.assertTrue(np.isnan(recording["track"][3, 1]).all())

    def test_mass_is_there_only_if_declared(self):
        maker.write_case(self.folder, self.data)
        self.assertNotIn("mass", self.convert())
        self.assertEqual(self.convert("--mass", 0.25)["mass"], 0.25)

    def test_every_pickle_protocol_gives_the_same(self):
        maker.write_case(self.folder, self.data)
        expected = self.convert()
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
            maker.write_pickle(self.folder / "final_data.pkl", self.data, protocol)
            for name, array in self.convert().items():
                np.testing.assert_array_equal(array, expected[name])

    def test_case_without_shape_prior_has_no_interior(self):
        self.data["surface_points"] = self.data["interior_points"] = np.zeros((0, 3))
        maker.write_case(self.folder, self.data)
        self.assertEqual(self.convert()["interior"].shape, (0, 3))

    def test_points_not_visible_in_frame_0_are_told(self):
        self.data["object_visibilities"][0, :2] = False
        self.data["object_visibilities"][1:, :2] = True
        self.data["object_motions_valid"][1:, :2] = True
        maker.write_case(self.folder, self.data)
        self.assertIn("note: 2 points", self.run_tool()[1])

    def test_case_without_controllers(self):
        self.data["controller_points"] = None
        maker.write_case(self.folder, self.data, split=None)
        self.assertEqual(self.convert()["controllers"].shape, (6, 0, 3))


class TwinTest(Case):
    def setUp(self):
        super().setUp()
        maker.write_case(self.folder, self.data)
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)

    def write_checkpoint(self, path=None, change=0):
        springs, _, object_springs = phystwin_springs.find_springs(
            self.particles(), self.data["controller_points"][0].astype(np.float32),
            maker.PARAMETERS)
        spring_Y = np.random.default_rng(2).uniform(1e4, 9e4, len(springs) + change)
        spring_Y[:2] = 2e5, 0
        maker.torch_save(maker.checkpoint(spring_Y, object_springs),
                         path or self.folder / "best_180.pth")
        return spring_Y.astype(np.float32)

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

    def test_results_are_found_where_phystwin_keeps_them(self):
        (self.folder / "optimal_params.pkl").unlink()
        results = self.root / "experiments_optimization" / "rope" / "optimal_params.pkl"
        maker.write_pickle(results, maker.PARAMETERS)
        experiment = self.root / "experiments" / "rope"
        spring_Y = self.write_checkpoint(experiment / "train" / "best_0.pth")
        twin = self.convert_twin("--mass", 61)  # 1 kg a particle
        np.testing.assert_allclose(twin["level0/stiffness"] * twin["level0/rest_length"],
                                   np.clip(spring_Y, 0, 1e5))

    def test_recording_only_writes_no_twin(self):
        self.convert("--recording-only")
        self.assertFalse((self.root / "rope.twin.npz").exists())

    def test_meta_names_the_recording_by_its_hash(self):
        meta = json.loads(self.convert_twin()["meta"].tobytes())
        self.assertEqual((meta["points"], meta["interior"], meta["controllers"]), (40, 21, 3))
        self.assertFalse(meta["controller_velocity"])
        file_hash = phystwin_to_npz.hash_bytes(self.output.read_bytes())
        self.assertEqual(meta["recordings"],
                         [{"name": "rope", "hash": file_hash, "train_frames": 4}])

    def test_hash_is_fnv_1a(self):
        # http://www.isthe.com/chongo/tech/comp/fnv: vectors of FNV-1a, 64 bits
        self.assertEqual(phystwin_to_npz.hash_bytes(b""), "cbf29ce484222325")
        self.assertEqual(phystwin_to_npz.hash_bytes(b"foobar"), "85944171f73967e8")

    @unittest.skipUnless("PHYSPRING" in os.environ, "PHYSPRING names no program")
    def test_physpring_takes_the_twin_as_trained_on_the_recording(self):
        springs = len(self.write_checkpoint())
        self.convert("--mass", 0.1)
        result = subprocess.run(
            [os.environ["PHYSPRING"], "eval", "rope.twin.npz", "rope.npz", "--json", "eval.json"],
            cwd=self.root, capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        level = json.loads((self.root / "eval.json").read_text())["levels"][0]
        self.assertEqual((level["nodes"], level["springs"], level["substeps"]), (61, springs, 667))
        self.assertIsNotNone(level["fit"])

    def test_checkpoint_of_another_run_is_refused(self):
        self.write_checkpoint(change=1)
        self.expect_refused("best_180.pth", "springs", "not of one run")

    def test_two_checkpoints_are_refused(self):
        self.write_checkpoint()
        self.write_checkpoint(self.folder / "best_20.pth")
        self.expect_refused("2 files best_*.pth", "--checkpoint")

    def test_checkpoint_without_parameters_is_refused(self):
        self.write_checkpoint()
        (self.folder / "optimal_params.pkl").unlink()
        self.expect_refused("best_180.pth", "optimal_params.pkl")

    def test_incomplete_parameters_are_refused(self):
        for change in ({"object_radius": None}, {"drag_damping": -1.0}, {"collide_fric": np.nan}):
            maker.write_pickle(self.folder / "optimal_params.pkl", {**maker.PARAMETERS, **change})
            self.expect_refused("optimal_params.pkl", *change)

    def test_checkpoint_in_the_old_format_is_refused(self):
        old = pickle.dumps(0x1950A86A20F9469CFC6C, 2) + pickle.dumps(1001, 2)
        (self.folder / "best_0.pth").write_bytes(old)
        self.expect_refused("best_0.pth", "before version 1.6")

    def test_checkpoint_cut_anywhere_is_refused(self):
        self.write_checkpoint()
        path = self.folder / "best_180.pth"
        whole = path.read_bytes()
        for size in range(0, len(whole), 97):
            path.write_bytes(whole[:size])
            self.expect_refused("best_180.pth")

    def test_code_in_a_checkpoint_is_not_run(self):
        maker.torch_save({"spring_Y": Command(self.root / "ran")}, self.folder / "best_0.pth")
        self.expect_refused("best_0.pth", "refused")


class Command:
    """Pickles as a call that makes a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


class BadInputTest(Case):
    def test_code_in_a_pickle_is_not_run(self):
        marker = self.root / "ran"
        maker.write_pickle(self.folder / "final_data.pkl", {"object_points": Command(marker)})
        self.expect_refused("final_data.pkl", "mkdir", "refused")
        self.assertFalse(marker.exists())
        with open(self.folder / "final_data.pkl", "rb") as file:
            pickle.load(file)
        self.assertTrue(marker.exists())  # which shows that it would have run

    def test_names_that_lead_to_code_are_refused(self):
        for name in (b"builtins\neval", b"builtins\ngetattr", b"numpy\nload", b"os\nsystem",
                     b"torch\nload", b"operator\nattrgetter"):
            path = self.root / "code.pkl"
            path.write_bytes(b"c" + name + b"\n.")
            with self.assertRaisesRegex(safe_pickle.Error, "refused"):
                safe_pickle.read_pickle(path)

    def test_pickle_cut_anywhere_is_refused(self):
        maker.write_case(self.folder, maker.final_data(frames=2, points=3))
        path = self.folder / "final_data.pkl"
        whole = path.read_bytes()
        for size in range(len(whole)):
            path.write_bytes(whole[:size])
            with self.assertRaises(safe_pickle.Error):
                safe_pickle.read_pickle(path)
        path.write_bytes(whole[:-1])
        self.expect_refused("final_data.pkl", "not a whole pickle")

    def test_damaged_pickle_never_escapes(self):
        random = np.random.default_rng(3)
        maker.write_case(self.folder, maker.final_data(frames=3, points=4))
        path = self.folder / "final_data.pkl"
        whole = bytearray(path.read_bytes())
        for _ in range(150):
            damaged = bytearray(whole)
            damaged[random.integers(len(whole))] = random.integers(256)
            path.write_bytes(damaged)
            status, error = self.run_tool()
            self.assertEqual(error.count("\n"), 1 if status else error.count("note:"), error)

    def test_arrays_that_do_not_fit_are_refused(self):
        good = self.data
        bad = {
            "object_points": good["object_points"][..., :2],
            "object_visibilities": good["object_visibilities"][:, 1:],
            "object_motions_valid": good["object_motions_valid"].astype(np.float32) + 0.5,
            "controller_points": good["controller_points"][1:],
            "surface_points": np.full((3, 3), np.nan),
            "interior_points": np.array(["x"] * 3, object),
        }
        for name, array in bad.items():
            maker.write_case(self.folder, {**good, name: array})
            self.expect_refused("final_data.pkl", name)

    def test_missing_arrays_are_refused(self):
        maker.write_case(self.folder, self.data)
        for name in ("object_points", "object_visibilities", "object_motions_valid",
                     "surface_points", "interior_points"):
            rest = {key: value for key, value in self.data.items() if key != name}
            maker.write_pickle(self.folder / "final_data.pkl", rest)
            self.expect_refused("final_data.pkl", f"no array {name}")

    def test_array_of_impossible_shape_is_refused(self):
        for shape in ((2 ** 70, 0), (1,) * 80, (-1, 3), (2, 3.0), "xy"):
            with self.assertRaisesRegex(safe_pickle.Error, "shape"):
                array = safe_pickle.Array()
                array.__setstate__((1, shape, safe_pickle._Dtype("f4"), False, b""))
                array.numpy()

    def test_visible_point_that_is_not_finite_is_refused(self):
        self.data["object_points"][0, 7] = np.inf
        maker.write_case(self.folder, self.data)
        self.expect_refused("object_points", "not finite")

    def test_point_that_is_never_seen_is_refused(self):
        self.data["object_visibilities"][:, 5] = False
        maker.write_case(self.folder, self.data)
        self.expect_refused("object_points", "point 5")

    def test_split_outside_the_clip_is_refused(self):
        for split in ((0, 7), (1, 4), (0, 1)):
            maker.write_case(self.folder, self.data, split=split)
            self.expect_refused("split.json")

    def test_track_that_is_too_short_is_refused(self):
        maker.write_case(self.folder, self.data, track=np.zeros((5, 2, 3)))
        self.expect_refused("gt_track_3d.pkl", "5 frames")

    def test_missing_case_is_refused(self):
        self.expect_refused("no such folder")
        self.folder.mkdir(parents=True)
        self.expect_refused("final_data.pkl", "No such file")

    def test_failed_write_leaves_what_was_there(self):
        maker.write_case(self.folder, self.data)
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)
        self.output.write_text("old")
        (self.root / "rope.twin.npz").mkdir()
        self.expect_refused("rope.twin.npz", "folder")
        self.assertEqual(self.output.read_text(), "old")
        self.output = self.root / "nowhere" / "rope.npz"
        self.expect_refused("nowhere", "No such file")

    def test_wrong_usage_ends_with_2(self):
        for options in (["--mass", "-1"], ["-o", "rope.twin.npz"], ["--unknown"]):
            with self.assertRaises(SystemExit) as end, contextlib.redirect_stderr(io.StringIO()):
                phystwin_to_npz.main(["case", "-o", str(self.output), *options])
            self.assertEqual(end.exception.code, 2)


if __name__ == "__main__":
    unittest.main()
