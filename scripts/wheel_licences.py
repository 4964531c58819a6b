#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""wheel_licences.py WHEEL FOLDER: writes the wheel to FOLDER with the licences of the libraries that
auditwheel has put into it. They are those that Debian has of the packages that the libraries are of.
Needs the package `wheel`.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def package_of(library):
    """The Debian package of a file libNAME.so.VERSION."""
    found = subprocess.run(['dpkg-query', '-S', f'*/{library}'], check=True, capture_output=True,
                           text=True).stdout
    return re.split('[:,]', found)[0]


def main(wheel, folder):
    with tempfile.TemporaryDirectory() as temporary:
        tool = [sys.executable, '-m', 'wheel']
        subprocess.run([*tool, 'unpack', '--dest', temporary, wheel], check=True,
                       stdout=subprocess.DEVNULL)
        root, = pathlib.Path(temporary).iterdir()
        licences = next(root.glob('*.dist-info')) / 'licenses'
        licences.mkdir(exist_ok=True)
        for library in sorted(root.glob('*.libs/*.so*')):
            # auditwheel puts a hash into the name: libzip-5c554ca2.so.4.0
            package = package_of(re.sub(r'-[0-9a-f]{8}\.so', '.so', library.name))
            shutil.copy(f'/usr/share/doc/{package}/copyright', licences / f'{package}.txt')
        subprocess.run([*tool, 'pack', '--dest-dir', folder, root], check=True,
                       stdout=subprocess.DEVNULL)


if __name__ == '__main__':
    main(*sys.argv[1:])
