# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_settings.py: how a case was filmed comes from its files, or is said.

The clips fall freely, so what is right is known: 9.8 m/s^2, downwards.
"""

import json
import os
import subprocess
import unittest

from phystwin_test_case import Case, half_turn, np  # first: it finds the tools, or skips
import phystwin_case_maker as maker

REAL = """data_type: "real"
FPS: {fps}   # as filmed
dt: 5e-5
num_substeps: {substeps}
collide_elas: 0.5
reverse_z: {reverse_z}
vp_front: [1, 0, -2]
"""


def falling(fps, z_up=False):
    """A case as the maker makes it that falls with 9.8 m/s^2 from 2 m above the ground."""
    data = maker.final_data(frames=6)
    data["object_visibilities"][:] = True
    data["object_motions_valid"][:-1] = True
    fall = 2 - 9.8 / 2 * (np.arange(6) / fps) ** 2
    for key in ("object_points", "controller_points"):
        height = fall[:, None] if key == "object_points" else 2.0
        data[key] = np.array(np.broadcast_to(data[key][0], data[key].shape), np.float64)
        data[key][..., 2] -= height
    for key in ("surface_points", "interior_points"):
        data[key][:, 2] -= 2
    if z_up:
        for key in ("object_points", "controller_points", "surface_points", "interior_points"):
            data[key] = half_turn(data[key])
    return data


class SettingsTest(Case):
    def configure(self, fps=30, substeps=667, reverse_z="true", path="configs/real.yaml"):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(REAL.format(fps=fps, substeps=substeps, reverse_z=reverse_z))

    def film(self, **metadata):
        self.folder.mkdir(parents=True, exist_ok=True)
        (self.folder / "metadata.json").write_text(json.dumps({"WH": [848, 480], **metadata}))

    def expect_fall(self, *options):
        """Converts, and claims the fall of 9.8 m/s^2; what was said."""
        status, said = self.run_tool("--mass", 0.1, *options)
        self.assertEqual(status, 0, said)
        with np.load(self.output) as recording:
            points, fps = recording["points"].astype(float), recording["fps"]
            np.testing.assert_array_equal(recording["gravity"], [0, 0, -9.8])
            np.testing.assert_array_equal(recording["ground"], [0, 0, 1, 0])
            self.assertTrue((recording["controllers"][..., 2] > 0).all())
            self.assertTrue((recording["interior"][..., 2] > 0).all())
        self.assertTrue((points[0, :, 2] > 0).all())
        velocity = (points[-1, :, 2] - points[0, :, 2]) / 5 * fps
        # the mean velocity of a fall is half that at its end; the points are float32
        np.testing.assert_allclose(2 * velocity / (5 / fps), -9.8, rtol=1e-3)
        return said

    def test_rate_is_that_of_the_metadata(self):
        maker.write_case(self.folder, falling(15))
        self.film(fps=15)
        self.configure(15, 1333)
        self.assertEqual(self.expect_fall(), "")

    def test_rate_is_that_of_the_configuration(self):
        maker.write_case(self.folder, falling(60))
        for path in ("configs/real.yaml", "data/different_types/rope/any.yaml"):
            self.configure(60, 333, path=path)
            self.assertEqual(self.expect_fall(), "")
            (self.root / path).unlink()
        self.configure(60, 333, path="elsewhere.yaml")
        self.assertEqual(self.expect_fall("--config", self.root / "elsewhere.yaml"), "")

    def test_cloth_has_a_configuration_of_its_own(self):
        self.folder = self.folder.with_name("double_lift_cloth")
        maker.write_case(self.folder, falling(20))
        self.configure(20, path="configs/cloth.yaml")
        self.configure(30)
        self.assertEqual(self.expect_fall(), "")

    def test_rate_that_nothing_says_is_said_to_be_assumed(self):
        maker.write_case(self.folder, falling(30))
        said = self.expect_fall("--reverse-z")
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn("30 frames a second are assumed", said)

    def test_conflict_of_rates_is_said_and_the_cameras_are_right(self):
        maker.write_case(self.folder, falling(15))
        self.film(fps=15)
        self.configure(30)
        said = self.expect_fall()
        self.assertEqual(said.count("\n"), 1, said)
        for word in ("15 in", "metadata.json", "30 in", "real.yaml", "15 is taken", "--fps"):
            self.assertIn(word, said)

    def test_flag_overrides_both(self):
        maker.write_case(self.folder, falling(7.5))
        self.film(fps=15)
        self.configure(30, reverse_z="false")
        self.assertEqual(self.expect_fall("--fps", 7.5, "--reverse-z"), "")

    def test_z_up_is_respected(self):
        maker.write_case(self.folder, falling(30, z_up=True))
        for word in ("false", "False", "no", "0", "false  # up"):
            self.configure(reverse_z=word)
            self.assertEqual(self.expect_fall(), "")
        self.configure(reverse_z="true")
        self.assertEqual(self.expect_fall("--no-reverse-z"), "")

    def test_z_that_nothing_says_puts_points_above_the_ground(self):
        for z_up in (False, True):
            maker.write_case(self.folder, falling(30, z_up))
            self.film(fps=30)
            said = self.expect_fall()
            self.assertEqual(said.count("\n"), 1, said)
            self.assertIn(f"{'up' if z_up else 'down'} is assumed", said)

    def test_wrong_z_is_doubted(self):
        maker.write_case(self.folder, falling(30, z_up=True))
        self.configure()
        self.assertIn("--no-reverse-z", self.run_tool("--mass", 0.1)[1])

    def test_z_up_keeps_every_number(self):
        data = falling(30, z_up=True)
        maker.write_case(self.folder, data, track=data["object_points"][:, :2])
        self.configure(reverse_z="false")
        recording = self.convert()
        for key, name in (("object_points", "points"), ("controller_points", "controllers")):
            np.testing.assert_array_equal(recording[name], data[key].astype(np.float32))
        np.testing.assert_array_equal(recording["track"],
                                      data["object_points"][:, :2].astype(np.float32))

    def test_frames_that_were_left_out_are_doubted(self):
        maker.write_case(self.folder, falling(15))
        self.film(fps=30, frame_num=12)
        self.configure()
        self.assertIn("12 frames, final_data.pkl has 6", self.run_tool("--mass", 0.1)[1])

    def test_self_collision_and_bounds_are_the_configurations(self):
        maker.write_case(self.folder, falling(30))
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)
        self.configure()
        twin = self.convert_twin()
        self.assertEqual(twin["level0/collision_distance"], 0)
        stiffness = twin["level0/stiffness"]
        with open(self.root / "configs/real.yaml", "a", encoding="utf-8") as file:
            file.write("self_collision: true\nspring_Y_max: 1.5e4\n")
        twin = self.convert_twin()
        self.assertEqual(twin["level0/collision_distance"], 0.02)
        np.testing.assert_allclose(twin["level0/stiffness"], stiffness / 2)  # Y is 3e4

    def test_substeps_are_phystwins_and_fill_the_frame(self):
        maker.write_case(self.folder, falling(15))
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)
        for fps, substeps in ((30, 667), (15, 1333), (29.97, 667), (10, 2000)):
            self.configure(fps, substeps)
            rate = self.convert_twin()["level0/substeps_per_second"]
            self.assertEqual(np.ceil(rate / fps - 1e-9), substeps)  # as ChooseSubsteps does

    def test_parameters_of_another_time_are_doubted(self):
        maker.write_case(self.folder, falling(10))
        maker.write_pickle(self.folder / "optimal_params.pkl", maker.PARAMETERS)
        self.configure(10, 100)  # 5 ms a frame of 100 ms, as in PhysTwin's synthetic.yaml
        self.assertIn("0.005 s a frame", self.run_tool("--mass", 0.1)[1])

    @unittest.skipUnless("PHYSPRING" in os.environ, "PHYSPRING names no program")
    def test_physpring_follows_the_fall_at_15_frames_a_second(self):
        maker.write_case(self.folder, falling(15))
        maker.write_pickle(self.folder / "optimal_params.pkl",
                           {**maker.PARAMETERS, "drag_damping": 0, "controller_radius": 1e-3})
        self.film(fps=15)
        self.configure(15, 1333)
        self.convert("--mass", 0.1)
        subprocess.run([os.environ["PHYSPRING"], "eval", "rope.twin.npz", "rope.npz", "--json",
                        "eval.json"], cwd=self.root, capture_output=True, check=True)
        level = json.loads((self.root / "eval.json").read_text())["levels"][0]
        # semi-implicit Euler is g t h / 2 off, 0.08 mm after 5 frames
        self.assertLess(level["prediction"]["track"], 1e-4)

    def test_bad_settings_are_refused(self):
        maker.write_case(self.folder, falling(15))
        for fps in (0, -15, "fast", float("nan"), float("inf"), True, [15], 10 ** 400, 1e9):
            self.film(fps=fps)
            self.expect_refused("metadata.json", "fps is")
        self.film(fps=15)
        for change in ({"fps": "fast"}, {"reverse_z": "maybe"}, {"substeps": 0}):
            self.configure(**{"fps": 15, **change})
            self.expect_refused("real.yaml", "expected")
        for text in (b"\xff", b"[1", b"[]", b"[" * 10 ** 5, b"9" * 5000, b" " * (1 << 23)):
            (self.folder / "metadata.json").write_bytes(text)
            self.expect_refused("metadata.json")

    def test_configuration_that_is_missing_or_not_the_only_one_is_refused(self):
        maker.write_case(self.folder, falling(15))
        self.expect_refused("nowhere.yaml", options=["--config", "nowhere.yaml"])
        for name in ("a.yaml", "b.yml"):
            self.configure(path=f"data/different_types/rope/{name}")
        self.expect_refused("--config")


if __name__ == "__main__":
    unittest.main()
