# SPDX-License-Identifier: Apache-2.0
"""What a twin still gets wrong, and which physical effect it lacks."""
from __future__ import annotations

import html
import json
import os
from collections.abc import Callable, Iterable
from typing import Any

from physpring import _core
from physpring._recordings import RecordingLike, recordings_of, seed_of, threads_of, twin_of


class Report:
    """What a diagnosis found. `print` shows the text of `physpring diagnose`; a notebook shows its
    page."""

    def __init__(self, finding: _core.Finding):
        self._finding = finding

    @property
    def twin(self) -> _core.Twin:
        """The twin, refitted with the effects that were found."""
        return self._finding.twin

    def to_dict(self) -> dict[str, Any]:
        """What is in report.json (docs/diagnose.md); lengths in metres."""
        return json.loads(self._finding.json())

    @property
    def effects(self) -> dict[str, dict[str, Any]]:
        """The accepted effects: parameters by name, with the unit in the name. Empty: none is
        missing."""
        return {effect['name']: effect['parameters'] for effect in self.to_dict()['effects']}

    def save(self, folder: str | os.PathLike) -> None:
        """Writes report.json, report.html and the twin, as `physpring diagnose -o FOLDER` does."""
        os.makedirs(folder, exist_ok=True)
        twin = self.twin
        name = os.path.basename(twin.path)
        if not name.endswith('.npz'):
            name += '.twin.npz'
        for file, text in (('report.json', self._finding.json()), ('report.html', self._page(name))):
            with open(os.path.join(folder, file), 'w', encoding='utf-8') as opened:
                opened.write(text)
        twin.save(os.path.join(folder, name))

    def _page(self, name: str) -> str:
        return self._finding.html('Diagnosis of ' + name)

    def __str__(self) -> str:
        return self._finding.text()

    def __repr__(self) -> str:
        found = ', '.join(self.effects) or 'nothing is missing'
        return f'<physpring.Report: {found}>'

    def _repr_html_(self) -> str:
        # a page of its own, so that its styles stay inside
        page = html.escape(self._page(os.path.basename(self.twin.path)), quote=True)
        return (f'<iframe srcdoc="{page}" width="100%" height="700" frameborder="0"></iframe>')


def diagnose(twin: _core.Twin | str | os.PathLike,
             recordings: RecordingLike | Iterable[RecordingLike],
             *,
             heldout: RecordingLike | Iterable[RecordingLike] = (),
             before: RecordingLike | Iterable[RecordingLike] = (),
             callback: Callable[[float, str], Any] | None = None,
             threads: int | None = None,
             seed: int = 0) -> Report:
    """Finds the physical effect that a twin lacks on recordings, and adds it, as `physpring
    diagnose` does.

    heldout: recordings to judge by; without them whole runs, future frames or blocks of frames are
        held out. before: recordings of the object before it changed. The program looks for those
        that the twin was trained on; here they must be given.
    callback: is called with the share of the work that is done (0 to 1) and what was done last.
    """
    return Report(
        _core.diagnose(twin_of(twin), recordings_of(recordings, 'fit'),
                       recordings_of(heldout, 'heldout'), recordings_of(before, 'fit'), seed_of(seed),
                       threads_of(threads), callback))
