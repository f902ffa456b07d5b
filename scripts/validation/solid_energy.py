# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid on an energy: the symmetric face gradient, and how a run judges its own result."""
from validation.parts.energy import beams, bending, defaults, modes, operator, pictures, plate, speed, wave

BARS = (operator.BARS + beams.BARS + bending.BARS + defaults.BARS + plate.BARS + modes.BARS +
        wave.BARS + speed.BARS + pictures.BARS)
