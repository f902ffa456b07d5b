# SPDX-License-Identifier: Apache-2.0
"""Bars of "fast again, and large"."""
from validation.parts.fast_and_large import large, start, step

BARS = [*step.BARS, *start.BARS, *large.BARS]
NOTE = "\n\n".join(part.NOTE for part in (step, start, large) if part.NOTE)
