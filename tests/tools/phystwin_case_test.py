# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_case.py: recordings are PhysTwin's points, and only whole ones."""

import pickle
import unittest

from phystwin_test_case import Case, half_turn, np  # first: it finds the tools, or skips
import phystwin_case_maker as maker


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


class RefusalTest(Case):
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


if __name__ == "__main__":
    unittest.main()
