#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a MuJoCo scene off-screen: picture_of_scene.py SCENE.xml PICTURE.png [--time SECONDS]

Needs the Python package mujoco-core[rendering] and OSMesa. The scene runs for the given time first;
its camera `view` is used.
"""
import argparse
import os
import struct
import zlib

os.environ.setdefault('MUJOCO_GL', 'osmesa')
import mujoco  # noqa: E402 (reads MUJOCO_GL)


def write_png(path, pixels):
    """Writes rows x columns x 3 bytes as an RGB picture."""
    rows, columns, _ = pixels.shape
    lines = b''.join(b'\0' + row.tobytes() for row in pixels)

    def chunk(kind, data):
        checksum = zlib.crc32(kind + data)
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', checksum)

    header = struct.pack('>IIBBBBB', columns, rows, 8, 2, 0, 0, 0)
    with open(path, 'wb') as file:
        file.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', header) +
                   chunk(b'IDAT', zlib.compress(lines, 9)) + chunk(b'IEND', b''))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('scene')
    parser.add_argument('picture')
    parser.add_argument('--time', type=float, default=0, help='seconds to run first')
    arguments = parser.parse_args()

    model = mujoco.MjModel.from_xml_path(arguments.scene)
    data = mujoco.MjData(model)
    while data.time < arguments.time:
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    with mujoco.Renderer(model, 480, 640) as renderer:
        renderer.update_scene(data, 'view')
        write_png(arguments.picture, renderer.render())


if __name__ == '__main__':
    main()
