# SPDX-License-Identifier: Apache-2.0
"""Bars of "right by default": what static solids give with no key of the method set."""
from validation.parts import right_by_default_scenes, right_by_default_stress

BARS = right_by_default_scenes.BARS + right_by_default_stress.BARS
