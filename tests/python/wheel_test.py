# SPDX-License-Identifier: Apache-2.0
"""wheel_test.py DIST ENVIRONMENT [PACKAGE ...]: the tests of the Python package, on the wheel of
DIST for this Python, in a virtual environment of its own that has no sources: first without MuJoCo,
then with it.

PACKAGE: more packages of PyPI to test with. Exits with 77 (skipped) where there is no wheel
(scripts/wheel builds it), or PyPI is out of reach.
"""
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).parent


def run(*command):
    subprocess.run([str(word) for word in command], check=True, stdin=subprocess.DEVNULL)


def skip(why):
    print(f'skipped: {why}')
    sys.exit(77)


def run_tests(python, tests, *options):
    """pytest, in a folder from which no source is imported."""
    run(python, '-P' if sys.version_info >= (3, 11) else '-s', '-m', 'pytest', '-q', '-p',
        'no:cacheprovider', '-o', 'python_files=test_*.py', '--rootdir', HERE, *options,
        *(HERE / name for name in tests))


def main(dist, environment, *packages):
    tag = f'cp{sys.version_info[0]}{sys.version_info[1]}'
    wheels = sorted(pathlib.Path(dist).glob(f'physpring-*-{tag}-*.whl'),
                    key=lambda wheel: wheel.stat().st_mtime)
    if not wheels:
        skip(f'no wheel for {tag} in {dist}; scripts/wheel builds it')
    wheel = wheels[-1].resolve()
    size = wheel.stat().st_size / 1e6
    print(f'{wheel.name}: {size:.1f} MB', flush=True)
    assert size < 25, 'the wheel is too large'
    environment = pathlib.Path(environment)
    shutil.rmtree(environment, ignore_errors=True)
    python = environment / 'bin' / 'python'
    pip = [python, '-m', 'pip', 'install', '-q', '--disable-pip-version-check']
    try:
        run(sys.executable, '-m', 'venv', environment)
        run(*pip, wheel, 'pytest')
    except subprocess.CalledProcessError:
        skip('python3-venv or PyPI is out of reach')
    run_tests(python, ['test_recording.py', 'test_training.py', 'test_simulator.py', 'test_package.py'])
    try:
        run(*pip, f'{wheel}[mujoco,envs,plan]', 'distributed', 'nbclient',
            'ipykernel', 'matplotlib', *packages)
    except subprocess.CalledProcessError:
        skip('MuJoCo or Gymnasium are out of reach')
    run_tests(python, ['.'])
    # the extra takes the newest 4.0.x; and the one that the package was built with
    run(*pip, 'mujoco-core==4.0.0')
    run_tests(python, ['test_package.py', 'test_export.py', 'test_envs.py'])


if __name__ == '__main__':
    main(*sys.argv[1:])
