# SPDX-License-Identifier: Apache-2.0
"""Bars of the symmetric gradient in bending: beams of few, slender, stretched and cut cells."""
from validation.job import Bar
from validation.parts.measures import recorded

BEAMS = "verification_solid_beams"
SLENDERNESS = (10, 20, 40, 100)


def errors(pattern, keys, low, high):
    """Errors of the tip of all keys lie between these two."""
    def measure(job):
        values, passed = recorded(job, BEAMS, pattern, " ".join(keys))
        return ", ".join(f"{100 * v:+.2f}" for v in values) + " %", passed and all(low <= v <= high for v in values)
    return measure


def told(job):
    """The difference of the face gradients that the run prints: stretched cells, and cubes in their place."""
    values, passed = recorded(job, BEAMS, "of_stretched_cells", " ".join(f"told_{cut}_{length}" for cut in CUTS for length in (20, 100)))
    (cubes,), _ = recorded(job, BEAMS, "of_stretched_cells", "told_of_cubes")
    return f"{100 * min(values):.0f} to {100 * max(values):.0f} %, of cubes in six {100 * cubes:.0f} %", passed and min(values) > 1.5 * cubes


CUTS = ("six_tetrahedra", "five_tetrahedra", "prisms_along_load", "prisms_across", "prisms_along_beam")
BARS = [
    Bar("beam 100:1, hexahedra 40x4x4: tip", "within 1 %", errors("slender_ones", ["hexahedra_40"], -0.01, 0.01)),
    Bar("beam 100:1, hexahedra 100x4x4: tip", "within 0.5 %", errors("slender_ones", ["hexahedra_100"], -0.005, 0.005)),
    Bar("beam 10:1, hexahedra 10x4x4 moved by 20 %: tip", "within 17 %, stiff", errors("moved_vertices", ["moved"], -0.17, 0)),
    *(Bar(f"beams 10, 20, 40, 100:1, {text} per cube, two and four across: tips", "within 2 %",
          errors("every_slenderness", [f"{cut}_{n}_{length}" for n in (2, 4) for length in SLENDERNESS], -0.02, 0.02), long=True)
      for cut, text in (("six_tetrahedra", "six tetrahedra"), ("five_tetrahedra", "five tetrahedra"))),
    *(Bar(f"beam 10:1, prisms along the load, across it and along the beam, {text} across: tips", f"within {100 * limit:g} %",
          errors("every_direction", [f"prisms_{way}_{n}" for way in ("along_load", "across", "along_beam")], -limit, limit), long=True)
      for n, text, limit in ((2, "two", 0.07), (4, "four", 0.025))),
    Bar("cells stretched 4:1, four across, 20 and 100:1: six tetrahedra per cell, prisms in three directions", "within 20 %, stiff",
        errors("of_stretched_cells", [f"stretched_{cut}_{length}" for cut in CUTS if cut != "five_tetrahedra" for length in (20, 100)], -0.2, 0),
        long=True),
    Bar("the same, five tetrahedra per cell", "within 20 %, stiff",
        errors("of_stretched_cells", ["stretched_five_tetrahedra_20", "stretched_five_tetrahedra_100"], -0.2, 0), long=True),
    Bar("stretched cells reported by the run's own indicator, the difference of the gradients", "half as much again as that of cubes", told, long=True),
    Bar("three-dimensional bending at nu 0.4999, two across: hexahedra, six and five tetrahedra per cube", "within 5 %",
        errors("near_incompressibility", [f"incompressible_{cut}" for cut in ("hexahedra", "six_tetrahedra", "five_tetrahedra")], -0.05, 0.05)),
    Bar("the same, prisms", "within 10 %", errors("near_incompressibility", ["incompressible_prisms_across"], -0.1, 0.1)),
]
