# SPDX-License-Identifier: Apache-2.0
"""Other methods as predictors of particles, for bench/compare_methods.py. They need torch."""
