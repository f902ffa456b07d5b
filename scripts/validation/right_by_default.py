# SPDX-License-Identifier: Apache-2.0
"""Bars of "right by default": what static solids give with no key of the method set."""
from validation.parts.right_by_default import before, elements, estimates, kept, loads, modes, motion, revolved, rubber, scenes, stability, stress

PARTS = (scenes, stress, motion, before, elements, estimates, loads, modes, stability, rubber, kept, revolved)
BARS = [bar for part in PARTS for bar in part.BARS]
