# SPDX-License-Identifier: Apache-2.0
"""needed_libraries_test.py LIBRARY: the plugin library needs nothing but the C library, so that it
loads in every process that has MuJoCo."""

import re
import subprocess
import sys

C_LIBRARY = {'libc.so.6', 'libm.so.6', 'libdl.so.2', 'ld-linux-x86-64.so.2',
             'ld-linux-aarch64.so.1'}


def main(library):
    section = subprocess.run(['readelf', '-d', library], check=True, capture_output=True,
                             text=True).stdout
    needed = re.findall(r'\(NEEDED\).*\[(.*)\]', section)
    print('needs', *needed)
    assert 'libc.so.6' in needed, section
    assert set(needed) <= C_LIBRARY, set(needed) - C_LIBRARY
    assert 'RUNPATH' not in section and 'RPATH' not in section, section


if __name__ == '__main__':
    main(*sys.argv[1:])
