# SPDX-License-Identifier: Apache-2.0
"""Bars of "right by default": what static solids give with no key of the method set."""
from validation.parts.right_by_default import estimates, loads, modes, motion, revolved, scenes, stability, stress

BARS = scenes.BARS + stress.BARS + motion.BARS + estimates.BARS + loads.BARS + modes.BARS + stability.BARS + revolved.BARS
