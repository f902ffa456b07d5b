# SPDX-License-Identifier: Apache-2.0
"""Bars of the tank's odd scenes."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, tests

BARS = [
    Bar("sun without a site, cut-off below restart, stopped tanks, absent ambient, 204 without a unit: reported or refused", "tests pass",
        gtests("unit_thermocline_plant", "Questions")),
    Bar("a blanket of a micrometre does not hang", "tests pass", gtests("verification_thermocline_tank", "blanket_of_a_micrometre")),
    Bar("porosity 1 has the fluid's temperature", "tests pass", gtests("verification_thermocline_tank", "without_filler")),
    Bar("temperatures between sections are interpolated", "tests pass", gtests("verification_solid_interface_data", "temperature"), ),
    Bar("coupled tank and wall", "tests pass", tests("^coupled_tank")),
]
