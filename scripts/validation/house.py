# SPDX-License-Identifier: Apache-2.0
"""Bars of "the house, third plan": what can be counted from the sources, and the minutes of a build (parts/house.py)."""
from validation.parts import house

BARS = house.BARS
SOURCES = ("CMakeLists.txt", "common", "coupler", "fluid_solver", "solid_solver", "mesh_mover", "thermocline", "plate_modal", "scripts", "tests",
           "benchmarks", "docs")
