# SPDX-License-Identifier: Apache-2.0
"""Tests of tools/phystwin_pictures.py: a case as PhysTwin leaves it, of two small cameras."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy as np
    from PIL import Image
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import phystwin_case_maker as maker  # noqa: E402

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "phystwin_pictures.py"
WIDTH, HEIGHT, FRAMES, CAMERAS = 8, 6, 2, 2
POSE = np.array([[0, 0, 1, 0.5], [-1, 0, 0, -0.25], [0, -1, 0, -0.75], [0, 0, 0, 1.0]])


class PicturesTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.case = pathlib.Path(folder.name) / "sloth"
        self.output = pathlib.Path(folder.name) / "pictures"
        self.case.mkdir()
        intrinsics = [[[9.0, 0, 4.0], [0, 8.0, 3.0], [0, 0, 1]]] * CAMERAS
        (self.case / "metadata.json").write_text(json.dumps(
            {"WH": [WIDTH, HEIGHT], "intrinsics": intrinsics, "frame_num": FRAMES, "fps": 30}))
        maker.write_pickle(self.case / "calibrate.pkl", [POSE] * CAMERAS)
        random = np.random.default_rng(0)
        for camera in range(CAMERAS):
            self.picture(f"mask/{camera}/0/x.png", np.zeros((HEIGHT, WIDTH), np.uint8))
            (self.case / f"mask/mask_info_{camera}.json").write_text('{"0": "hand", "1": "sloth"}')
            for frame in range(FRAMES):
                self.picture(f"color/{camera}/{frame}.png",
                             random.integers(0, 255, (HEIGHT, WIDTH, 3), np.uint8))
                hand, sloth = (np.zeros((HEIGHT, WIDTH), np.uint8) for _ in range(2))
                sloth[2:5, 1:6], hand[1:3, 4:7] = 255, 255
                self.picture(f"mask/{camera}/0/{frame}.png", hand)
                self.picture(f"mask/{camera}/1/{frame}.png", sloth)
                path = self.case / f"depth/{camera}/{frame}.npy"
                path.parent.mkdir(parents=True, exist_ok=True)
                np.save(path, np.full((HEIGHT, WIDTH), 812, np.uint16))

    def picture(self, name, pixels):
        path = self.case / name
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(pixels).save(path)

    def run_tool(self, *flags):
        return subprocess.run([sys.executable, TOOL, self.case, "-o", self.output, *flags],
                              capture_output=True, text=True)

    def test_pictures_are_as_filmed(self):
        done = self.run_tool("--no-reverse-z")
        self.assertEqual(done.returncode, 0, done.stderr)
        for camera in range(CAMERAS):
            one = np.asarray(Image.open(self.case / f"color/{camera}/1.png"))
            np.testing.assert_array_equal(
                np.asarray(Image.open(self.output / f"color/{camera}/00001.png")), one)
        mask = np.asarray(Image.open(self.output / "mask/0/00000.png"))
        self.assertEqual((mask == 128).sum(), 6)  # the hand, also where it hides the object
        self.assertEqual((mask == 255).sum(), 15 - 2)
        depth = np.asarray(Image.open(self.output / "depth/1/00001.png"))
        self.assertTrue((depth == 812).all())
        cameras = json.loads((self.output / "cameras.json").read_text())
        self.assertEqual((cameras["frames"], cameras["fps"], cameras["depth_unit"]),
                         (FRAMES, 30, 0.001))
        self.assertEqual(cameras["cameras"][1]["cx"], 4.5)
        np.testing.assert_allclose(np.reshape(cameras["cameras"][0]["pose"], (4, 4)), POSE)

    def test_z_is_turned_up_as_the_recording_is(self):
        done = self.run_tool("--reverse-z")
        self.assertEqual(done.returncode, 0, done.stderr)
        cameras = json.loads((self.output / "cameras.json").read_text())
        pose = np.reshape(cameras["cameras"][0]["pose"], (4, 4))
        np.testing.assert_allclose(pose[:3, 3], [0.5, 0.25, 0.75])

    def test_what_is_missing_is_one_line(self):
        (self.case / "color/1/1.png").unlink()
        done = self.run_tool()
        self.assertEqual(done.returncode, 1)
        self.assertIn("color/1/1.png", done.stderr.splitlines()[-1])
        self.assertEqual(list(self.output.parent.iterdir()), [self.case])

    def test_files_of_another_kind_are_refused(self):
        for name, text, message in (("mask/mask_info_0.json", "[1]", "mask_info_0.json"),
                                    ("mask/mask_info_0.json", '{"x": "cloth"}', "mask_info_0.json"),
                                    ("metadata.json", "{}", "lacks WH")):
            with self.subTest(text):
                path = self.case / name
                before = path.read_text()
                path.write_text(text)
                done = self.run_tool()
                path.write_text(before)
                self.assertEqual(done.returncode, 1)
                self.assertIn(message, done.stderr)
                self.assertNotIn("Traceback", done.stderr)

    def test_sizes_that_disagree_are_refused(self):
        self.picture("color/0/0.png", np.zeros((4, 4, 3), np.uint8))
        done = self.run_tool()
        self.assertEqual(done.returncode, 1)
        self.assertIn("has 4 x 4 pixels; metadata.json says 8 x 6", done.stderr)


if __name__ == "__main__":
    unittest.main()
