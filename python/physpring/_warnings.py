# SPDX-License-Identifier: Apache-2.0
"""The warnings that the engine gives."""
from __future__ import annotations

import warnings
from collections.abc import Iterable


class PhyspringWarning(UserWarning):
    """What the user should know: a guess in the place of data, a twin that explains little ..."""


def warn(lines: Iterable[str]) -> None:
    """Each line as a warning, of the caller's caller."""
    for line in lines:
        warnings.warn(line, PhyspringWarning, stacklevel=3)
