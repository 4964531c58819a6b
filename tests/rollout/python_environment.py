# SPDX-License-Identifier: Apache-2.0
"""A Python environment of its own for a test, with packages from PyPI; made once, then kept."""
import pathlib
import subprocess
import sys
import venv

SKIPPED = 77  # CTest's exit status for a test that could not be run


def python_with(folder, packages):
    """The interpreter of an environment in `folder` with these packages. Exits with status 77, and
    says why, where they cannot be installed."""
    python = pathlib.Path(folder) / 'bin' / 'python'
    done = pathlib.Path(folder) / 'packages.txt'
    if done.exists() and done.read_text() == '\n'.join(packages):
        return str(python)
    try:
        venv.create(folder, with_pip=True)
        subprocess.run([python, '-m', 'pip', 'install', '--quiet', *packages], check=True,
                       timeout=400)
    except (subprocess.SubprocessError, OSError) as error:
        print(f'SKIPPED: {packages} cannot be installed from PyPI: {error}')
        sys.exit(SKIPPED)
    done.write_text('\n'.join(packages))
    return str(python)
