# SPDX-License-Identifier: Apache-2.0
"""find_mujoco_test.py CMAKE SOURCES: which versions of MuJoCo the build takes, tried on folders that
look like a wheel's."""

import pathlib
import subprocess
import sys
import tempfile

PROJECT = """cmake_minimum_required(VERSION 3.25)
project(find LANGUAGES NONE)
list(APPEND CMAKE_MODULE_PATH "{sources}/cmake")
{find}
message(STATUS "takes ${{MuJoCo_VERSION}} in ${{MuJoCo_LIBRARY}}")
"""


def wheel(folder, header, library):
    (folder / 'include' / 'mujoco').mkdir(parents=True)
    (folder / 'include' / 'mujoco' / 'mujoco.h').write_text(f'#define mjVERSION_HEADER {header}\n')
    (folder / f'libmujoco.so.{library}').touch()


def configure(cmake, sources, header, library):
    """What CMake says of a wheel whose header and library have these versions."""
    top = (pathlib.Path(sources) / 'CMakeLists.txt').read_text().splitlines()
    start = next(i for i, line in enumerate(top) if line.startswith('file(STRINGS third_party'))
    end = next(i for i, line in enumerate(top) if line.startswith('find_package(MuJoCo'))
    find = '\n'.join(top[start:end + 1]).replace('third_party', f'{sources}/third_party')
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        wheel(folder / 'mujoco', header, library)
        (folder / 'CMakeLists.txt').write_text(PROJECT.format(sources=sources, find=find))
        done = subprocess.run([cmake, '-S', folder, '-B', folder / 'build',
                               f'-DMuJoCo_ROOT={folder}/mujoco'], capture_output=True, text=True)
    return done.returncode, ' '.join((done.stdout + done.stderr).split())


def main(cmake, sources):
    for header, library in ((4000000, '4.0.0'), (4000001, '4.0.1')):
        status, text = configure(cmake, sources, header, library)
        assert status == 0 and f'takes {library} in ' in text, text
    for header, library in ((4001000, '4.1.0'), (3017000, '3.17.0'), (334, '3.3.4')):
        status, text = configure(cmake, sources, header, library)
        assert status != 0 and f'unsuitable version "{library}"' in text, text
        assert 'MuJoCo 4.0 is needed: run scripts/setup' in text, text
    status, text = configure(cmake, sources, 4000001, '4.0.0')
    assert status != 0 and 'headers of 4.0.1 in' in text, text


if __name__ == '__main__':
    main(*sys.argv[1:])
