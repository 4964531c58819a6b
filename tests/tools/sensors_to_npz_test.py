# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/sensors_to_npz.py on a plate that moves before two cameras. PHYSPRING, where set, is
the program that reads its output."""

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
try:
    import numpy as np
except ImportError:
    print("skipped: needs numpy")
    sys.exit(77)
import sensors_to_npz
from depth_camera import depth_at

WIDTH, HEIGHT, FRAMES = 160, 120, 5
LENS = {"fx": 150.0, "fy": 140.0, "cx": 80.0, "cy": 60.0}


def pose(place, target):
    """camera_to_world of a camera that looks at a target; y of its image points down."""
    forward = (target - place) / np.linalg.norm(target - place)
    right = np.cross(forward, [0, 0, 1])
    right /= np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    matrix[:3, 3] = place
    return matrix


class Scene:
    """Points on the plane x = distance(t), 0.4 m x 0.3 m, seen by cameras at x = -1."""

    def __init__(self):
        y, z = np.meshgrid(np.linspace(-0.2, 0.2, 7), np.linspace(0.4, 0.7, 5))
        self.points = np.stack([np.stack([np.full(y.size, 0.01 * t), y.ravel(), z.ravel()], axis=1)
                                for t in range(FRAMES)])

    def pixels(self, matrix):
        own = (self.points - matrix[:3, 3]) @ matrix[:3, :3]
        return np.stack([LENS["fx"] * own[..., 0] / own[..., 2] + LENS["cx"],
                         LENS["fy"] * own[..., 1] / own[..., 2] + LENS["cy"]], axis=-1)

    def depth(self, matrix, frame):
        """By rays that hit the plane; 0 beside the plate."""
        u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
        rays = np.stack([(u - LENS["cx"]) / LENS["fx"], (v - LENS["cy"]) / LENS["fy"],
                         np.ones(u.shape)], axis=-1)
        world = rays @ matrix[:3, :3].T
        depth = (0.01 * frame - matrix[0, 3]) / world[..., 0]
        hit = matrix[:3, 3] + world * depth[..., None]
        on = (abs(hit[..., 1]) < 0.22) & (hit[..., 2] > 0.38) & (hit[..., 2] < 0.72)
        return np.where(on, depth, 0)


class SensorsTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.root = pathlib.Path(temporary.name)
        self.output = self.root / "out.npz"
        self.scene = Scene()
        self.cameras = [pose(np.array([-1, side, 0.6]), np.array([0, 0, 0.55]))
                        for side in (-0.4, 0.5)]
        hands = self.scene.points[:, :2] + [0, 0, -0.02]
        np.save(self.root / "hands.npy", hands)

    def write_view(self, number, tracks=None):
        matrix = self.cameras[number]
        camera = self.root / f"camera_{number}.json"
        camera.write_text(json.dumps({**LENS, "camera_to_world": matrix.tolist()}))
        depths, masks = self.root / f"depth_{number}", self.root / f"masks_{number}"
        depths.mkdir(exist_ok=True)
        masks.mkdir(exist_ok=True)
        for t in range(FRAMES):
            depth = self.scene.depth(matrix, t)
            np.save(depths / f"{t:03}.npy", np.rint(depth * 1e4).astype(np.uint16))
            np.save(masks / f"{t:03}.npy", depth > 0)
        file = self.root / f"tracks_{number}.npz"
        pixels = self.scene.pixels(matrix)
        np.savez(file, **(tracks(pixels) if tracks else {"tracks": pixels}))
        return file, masks, depths, camera

    def convert(self, *words, common=True):
        arguments = [str(word) for word in words] + ["-o", str(self.output), "--force"]
        if common:
            arguments += ["--controllers", str(self.root / "hands.npy"), "--fps", "30"]
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            sensors_to_npz.main(arguments)
        with np.load(self.output) as arrays:
            return dict(arrays)

    def refusal(self, *words, common=True):
        with self.assertRaises(SystemExit) as raised:
            self.convert(*words, common=common)
        message = str(raised.exception)
        self.assertTrue(message.startswith("sensors_to_npz: error: "), message)
        self.assertNotIn("\n", message)
        return message

    def test_tracks_with_depth_are_where_the_points_are(self):
        file, _, depths, camera = self.write_view(0)
        arrays = self.convert("tracks", "--view", file, depths, camera, "--depth-unit", "1e-4",
                              "--mass", "0.2")
        # a pixel's depth is that of its middle: half a pixel is 4 mm here
        np.testing.assert_allclose(arrays["points"], self.scene.points, atol=5e-3)
        self.assertLess(abs(arrays["points"] - self.scene.points).mean(), 1e-3)
        self.assertEqual(arrays["fps"], 30)
        self.assertEqual(arrays["mass"], 0.2)
        self.assertEqual(arrays["controllers"].shape, (FRAMES, 2, 3))

    def test_the_ground_is_where_it_is_said_to_be(self):
        file, _, depths, camera = self.write_view(0)
        words = ["tracks", "--view", file, depths, camera, "--ground", "-0.1"]
        np.testing.assert_array_equal(self.convert(*words)["ground"], [0, 0, 1, -0.1])
        self.assertNotIn("ground", self.convert(*words[:-2]))

    def test_at_an_edge_a_point_has_the_depth_of_the_near_side(self):
        image = np.full((9, 9), 2.0)
        image[:, 4:] = np.linspace(1, 1.004, 5)  # a surface in front of another one
        image[0, 0] = 0
        at = depth_at(image, np.array([[3.4, 5], [3.6, 5], [6.2, 5], [1, 5], [0, 0], [9, 9]]))
        np.testing.assert_allclose(at, [1, 1, 1.002, 2, np.nan, np.nan], atol=1e-9)

    def test_two_cameras_give_their_points_side_by_side(self):
        views = [self.write_view(number) for number in (0, 1)]
        arrays = self.convert("tracks", *(word for f, _, d, c in views
                                          for word in ("--view", f, d, c)), "--depth-unit", "1e-4")
        self.assertEqual(arrays["points"].shape, (FRAMES, 70, 3))
        np.testing.assert_allclose(arrays["points"][:, 35:], self.scene.points, atol=5e-3)

    def test_points_that_are_not_visible_are_not_seen(self):
        visible = np.ones((FRAMES, 35))
        visible[2, 4] = 0
        visible[:, 7] = 0
        layouts = [
            lambda p: {"tracks": p[None], "visibility": visible[None]},
            lambda p: {"tracks": p.swapaxes(0, 1), "occluded": 1 - visible.T},
        ]
        for layout in layouts:
            file, _, depths, camera = self.write_view(0, layout)
            points = self.convert("tracks", "--view", file, depths, camera, "--depth-unit",
                                  "1e-4")["points"]
            self.assertEqual(points.shape, (FRAMES, 34, 3))  # one is never visible
            self.assertTrue(np.isnan(points[2, 4]).all())
            self.assertEqual(np.isnan(points).sum(), 3)

    def test_masks_with_depth_make_clouds_on_the_surface(self):
        views = [self.write_view(number) for number in (0, 1)]
        arrays = self.convert("depth", *(word for _, m, d, c in views
                                         for word in ("--view", m, d, c)),
                              "--depth-unit", "1e-4", "--most", "150")
        self.assertEqual(arrays["surface"].shape, (FRAMES, 300, 3))
        self.assertNotIn("points", arrays)
        for t in range(FRAMES):
            np.testing.assert_allclose(arrays["surface"][t, :, 0], 0.01 * t, atol=3e-4)
        self.assertGreater(np.ptp(arrays["surface"][0, :, 1]), 0.4)

    @unittest.skipUnless("PHYSPRING" in os.environ, "PHYSPRING names no program")
    def test_physpring_registers_the_clouds(self):
        _, masks, depths, camera = self.write_view(0)
        self.convert("depth", "--view", masks, depths, camera, "--depth-unit", "1e-4")
        named = self.root / "named.npz"
        result = subprocess.run([os.environ["PHYSPRING"], "register", self.output, "-o", named],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        with np.load(named) as arrays:
            moved = np.nanmean(arrays["points"][4, :, 0] - arrays["points"][0, :, 0])
        self.assertAlmostEqual(moved, 0.04, delta=2e-3)

    def write_cloud(self, path, cloud):
        number = len(cloud)
        if path.suffix == ".npy":
            np.save(path, cloud)
            return
        binary = "binary" in path.stem
        rows = np.column_stack([cloud, np.full(number, 7)])
        if path.suffix == ".ply":
            form = "binary_little_endian" if binary else "ascii"
            head = (f"ply\nformat {form} 1.0\ncomment made\nelement vertex {number}\n"
                    "property float x\nproperty float y\nproperty float z\n"
                    "property float intensity\nelement face 0\n"
                    "property list uchar int vertex_indices\nend_header\n")
        else:
            head = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 4\nTYPE F F F F\n"
                    f"COUNT 1 1 1 1\nWIDTH {number}\nHEIGHT 1\nPOINTS {number}\n"
                    f"DATA {'binary' if binary else 'ascii'}\n")
        body = (rows.astype("<f4").tobytes() if binary else
                "\n".join(" ".join(f"{x:.7g}" for x in row) for row in rows).encode() + b"\n")
        path.write_bytes(head.encode() + body)

    def test_folders_of_clouds(self):
        folder = self.root / "clouds"
        folder.mkdir()
        clouds = [frame[:20 + t].astype(np.float32) for t, frame in enumerate(self.scene.points)]
        names = ["0_text.ply", "1_binary.ply", "2_text.pcd", "3_binary.pcd", "4.npy"]
        for name, cloud in zip(names, clouds):
            self.write_cloud(folder / name, cloud)
        surface = self.convert("clouds", folder)["surface"]
        self.assertEqual(surface.shape, (FRAMES, 24, 3))
        for t, cloud in enumerate(clouds):
            np.testing.assert_allclose(surface[t, :len(cloud)], cloud, atol=1e-6)
            self.assertTrue(np.isnan(surface[t, len(cloud):]).all())

    def test_numbers_in_names_count_as_numbers(self):
        folder = self.root / "frames"
        folder.mkdir()
        for frame in range(8, 8 + FRAMES):
            np.save(folder / f"cloud{frame}.npy", np.full((5, 3), 0.1 * frame))
        arrays = self.convert("clouds", folder)
        np.testing.assert_allclose(arrays["surface"][:, 0, 0], 0.1 * np.arange(8, 8 + FRAMES), atol=1e-6)

    def test_numbers_in_names_may_be_times(self):
        folder = self.root / "frames"
        folder.mkdir()
        times = ["9.0", "9.02", "9.1", "10", "10.05"]
        for frame, time in enumerate(times):
            np.save(folder / f"at_{time}.npy", np.full((5, 3), 0.1 * frame))
        arrays = self.convert("clouds", folder)
        np.testing.assert_allclose(arrays["surface"][:, 0, 0], 0.1 * np.arange(FRAMES), atol=1e-6)

    def test_motion_capture(self):
        try:
            import ezc3d
        except ImportError:
            self.skipTest("needs ezc3d")
        take = ezc3d.c3d()
        points = np.ones((4, 35 + 2, FRAMES))
        # millimetres, y up: (x, z, -y)
        everything = np.concatenate([self.scene.points, self.scene.points[:, :2] - 0.02], axis=1)
        x, y, z = np.transpose(1e3 * everything, (2, 1, 0))
        points[:3] = np.stack([x, z, -y])
        points[:3, 3, 1] = np.nan
        take["parameters"]["POINT"]["RATE"]["value"] = [120]
        take["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
        take["parameters"]["POINT"]["LABELS"]["value"] = (
            [f"rope_{i}" for i in range(35)] + ["hand_l", "hand_r"])
        take["data"]["points"] = points
        file = self.root / "take.c3d"
        take.write(str(file))
        arrays = self.convert("c3d", file, "--held", "hand_l,hand_r", "--up", "y", common=False)
        self.assertEqual(arrays["fps"], 120)
        self.assertTrue(np.isnan(arrays["points"][1, 3]).all())
        arrays["points"][1, 3] = self.scene.points[1, 3]
        np.testing.assert_allclose(arrays["points"], self.scene.points, atol=1e-5)
        np.testing.assert_allclose(arrays["controllers"], self.scene.points[:, :2] - 0.02, atol=1e-5)
        self.assertIn("has no marker wrist", self.refusal("c3d", file, "--held", "wrist",
                                                          common=False))

    def test_bad_inputs_are_refused_in_a_line(self):
        file, masks, depths, camera = self.write_view(0)
        absent = self.root / "absent"
        self.assertIn("absent", self.refusal("tracks", "--view", absent, depths, camera))
        self.assertIn("has no images", self.refusal("tracks", "--view", file, absent, camera))
        self.assertIn("camera_to_world", self.refusal("tracks", "--view", file, depths, absent))
        broken = self.root / "broken.json"
        broken.write_text(json.dumps(LENS))
        self.assertIn("has no camera_to_world",
                      self.refusal("tracks", "--view", file, depths, broken))
        broken.write_text(json.dumps({**LENS, "camera_to_world": np.diag([2.0, 2, 2, 1]).tolist()}))
        self.assertIn("not begin with a rotation",
                      self.refusal("tracks", "--view", file, depths, broken))
        hidden = self.write_view(0, lambda p: {"tracks": p, "visibility": np.zeros(p.shape[:2])})
        self.assertIn("no point is visible", self.refusal("tracks", "--view", hidden[0], depths,
                                                          camera))
        (self.root / "cut.npz").write_bytes(file.read_bytes()[:200])
        self.assertIn("cut.npz", self.refusal("tracks", "--view", self.root / "cut.npz", depths,
                                              camera))
        whole = np.load(depths / "002.npy")
        np.save(depths / "002.npy", whole[:50])
        self.assertIn("002.npy: has the shape (50, 160)",
                      self.refusal("depth", "--view", masks, depths, camera))
        np.save(depths / "002.npy", whole)
        (depths / "004.npy").unlink()
        self.assertIn("has 4 depth images", self.refusal("tracks", "--view", file, depths, camera))
        self.assertIn("has 5 masks", self.refusal("depth", "--view", masks, depths, camera))
        np.save(self.root / "hands.npy", np.zeros((3, 2, 3)))
        folder = self.root / "clouds"
        folder.mkdir()
        self.assertIn("has 0 clouds", self.refusal("clouds", folder))
        for name, data in (("0.ply", b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                     b"property float y\nproperty float z\nend_header\n1 2 3\n"),
                           ("1.ply", b"nothing"),
                           ("3.pcd", b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 99999999\n"
                                     b"POINTS 1\nDATA binary\n" + bytes(12)),
                           ("2.pcd", b"FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 99999999999\n"
                                     b"DATA binary\n")):
            for path in folder.iterdir():
                path.unlink()
            np.save(folder / "9.npy", np.zeros((4, 3)))
            (folder / name).write_bytes(data)
            self.assertIn(name, self.refusal("clouds", folder))
        for path in folder.iterdir():
            path.unlink()
        for t in range(FRAMES):
            np.save(folder / f"{t}.npy", np.random.default_rng(t).random((9, 3)))
        self.assertIn("expected (5, C, 3)", self.refusal("clouds", folder))
        self.assertFalse(self.output.exists())


if __name__ == "__main__":
    unittest.main()
