# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid at large strain: bending, swinging, near incompressibility, rigid rotation, Newton's method."""
from validation.parts import finite_bending, finite_motion, finite_speed

BARS = finite_bending.BARS + finite_motion.BARS + finite_speed.BARS
