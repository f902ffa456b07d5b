# SPDX-License-Identifier: Apache-2.0
"""Measures of the symmetric gradient in bending: beams of few, slender, stretched and cut cells."""
from validation.shapes import recorded

BEAMS = "verification_solid_beams"


def told(job):
    """The difference of the face gradients that the run prints: stretched cells, and cubes in their place."""
    values, passed = recorded(job, BEAMS, "of_stretched_cells", " ".join(f"told_{cut}_{length}" for cut in CUTS for length in (20, 100)))
    (cubes,), _ = recorded(job, BEAMS, "of_stretched_cells", "told_of_cubes")
    return f"{100 * min(values):.0f} to {100 * max(values):.0f} %, of cubes in six {100 * cubes:.0f} %", passed and min(values) > 1.5 * cubes


CUTS = ("six_tetrahedra", "five_tetrahedra", "prisms_along_load", "prisms_across", "prisms_along_beam")
