# SPDX-License-Identifier: Apache-2.0
"""Bars of "fast again, and large"."""
from validation.parts.fast_and_large import start, step

BARS = [*step.BARS, *start.BARS]
NOTE = f"{step.NOTE}\n\n{start.NOTE}"
