# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/ run, each in a folder of its own, and their assertions hold."""
import pathlib

import pytest

nbclient = pytest.importorskip('nbclient')
nbformat = pytest.importorskip('nbformat')
FOLDER = pathlib.Path(__file__).parents[2] / 'docs' / 'notebooks'
NEEDS = {'quickstart': ['mujoco', 'matplotlib'], 'own_data': [], 'diagnosis': ['mujoco'],
         'inverse_problem': ['torch'], 'environments': ['gymnasium', 'matplotlib']}


def test_all_are_listed():
    assert {path.stem for path in FOLDER.glob('*.ipynb')} == set(NEEDS)


@pytest.mark.parametrize('name', NEEDS)
def test_runs(name, tmp_path):
    for package in NEEDS[name]:
        pytest.importorskip(package)
    notebook = nbformat.read(FOLDER / f'{name}.ipynb', as_version=4)
    for cell in notebook.cells:
        assert cell.cell_type != 'code' or not cell.outputs  # they are made anew
    nbclient.NotebookClient(notebook, timeout=600, kernel_name='python3',
                            resources={'metadata': {'path': str(tmp_path)}}).execute()
