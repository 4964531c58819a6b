# SPDX-License-Identifier: Apache-2.0
"""Makes `import mujoco` load PhySPRING's engine plugins (entry point group mujoco.plugins).

A package of its own, so that `import mujoco` does not import all of physpring.
"""

import os

LIBRARY = os.path.join(os.path.dirname(os.path.dirname(__file__)), 'physpring', 'plugin',
                       'libphyspring_plugin.so')


def load():
    """Registers physpring.springs, .contact and .force; once is enough."""
    import mujoco  # in here, because importing mujoco calls this
    mujoco.mj_loadPluginLibrary(LIBRARY)
