# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid at large strain: bending, oscillation, near incompressibility, rigid rotation, Newton's method."""
from validation.parts.finite import bending, motion, speed

BARS = bending.BARS + motion.BARS + speed.BARS
