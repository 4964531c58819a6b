# SPDX-License-Identifier: Apache-2.0
"""What pyproject.toml cannot say: the package holds a library for one kind of machine."""

import setuptools


class BinaryDistribution(setuptools.Distribution):
    def has_ext_modules(self):
        return True


setuptools.setup(distclass=BinaryDistribution)
