# SPDX-License-Identifier: Apache-2.0
import json

import physpring
import pytest
from conftest import expect_same_arrays, recording_of, run_program


def test_is_the_programs(twin, tmp_path):
    blown = recording_of('blown', 3, wind=0.02)
    blown.save(tmp_path / 'blown.npz')
    twin.copy().save(tmp_path / 'chain.twin.npz')
    told = []
    report = physpring.diagnose(tmp_path / 'chain.twin.npz', tmp_path / 'blown.npz',
                                callback=lambda share, status: told.append(share))
    run_program('diagnose', tmp_path / 'chain.twin.npz', tmp_path / 'blown.npz', '-o',
                tmp_path / 'theirs')
    report.save(tmp_path / 'ours')
    theirs = tmp_path / 'theirs'
    assert report.to_dict() == json.loads((theirs / 'report.json').read_text())
    assert (tmp_path / 'ours' / 'report.html').read_text() == (theirs / 'report.html').read_text()
    expect_same_arrays(tmp_path / 'ours' / 'chain.twin.npz', theirs / 'chain.twin.npz')
    assert told
    assert list(report.effects) == [effect['name'] for effect in report.to_dict()['effects']]
    assert '<iframe' in report._repr_html_()
    assert str(report)


def test_says_what_is_wrong(twin, other_recording):
    with pytest.raises(physpring.Error, match='no recording is given'):
        physpring.diagnose(twin, [])
    with pytest.raises(physpring.Error, match='is among the recordings to fit, too'):
        physpring.diagnose(twin, other_recording, heldout=other_recording)
