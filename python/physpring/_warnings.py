# SPDX-License-Identifier: Apache-2.0
"""The class of the warnings that the engine gives."""


class PhyspringWarning(UserWarning):
    """What the user should know: a guess in the place of data, a twin that explains little ..."""
