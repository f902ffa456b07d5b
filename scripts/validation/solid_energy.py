# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid on an energy: the symmetric face gradient, and what a run says of its own answer."""
from validation.parts import (energy_beams, energy_bending, energy_defaults, energy_modes, energy_operator, energy_pictures, energy_plate,
                              energy_speed, energy_wave)

BARS = (energy_operator.BARS + energy_beams.BARS + energy_bending.BARS + energy_defaults.BARS + energy_plate.BARS + energy_modes.BARS +
        energy_wave.BARS + energy_speed.BARS + energy_pictures.BARS)
