# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid's boundary conditions, materials and bad input, and its orders of accuracy: test executables."""
import re

from validation.job import Bar
from validation.parts.measures import all_pass, at_least, at_most, programs_pass


def wrong_input(job):
    passed, total, _, output = job.ctest("^wrong_configurations|cli_wrong")
    found = re.findall(r"(\d+) wrong configurations|^(\d+) of \d+", output, flags=re.M)
    return f"{passed} of {total} test programs passed" + (f", {max(found[-1])} configurations" if found else ""), (
        total > 0 and passed == total)


ORDER, CLOSED = "verification_solid_order", "verification_solid_closed_forms"
MATERIALS, CONDITIONS, PATCH = (f"verification_solid_{n}" for n in ("materials", "conditions", "patch"))
MESHES = [change + kind for kind in ("hexahedra", "tetrahedra", "prisms", "mixed", "quadrilaterals", "triangles")
          for change in ("", "perturbed_")]
CONDITIONS_EXACT = ("by_component|springs_with_displaced|zero_normal_gradient|soft_and_hard|parts_of_a_patch")

BARS = [
    *(bar for name in MESHES for bar in (
        Bar(f"MMS {name.replace('_', ' ')}: slope of the displacement, least-squares and corrected gradient", ">= 1.9",
            at_least(ORDER, f"/{name}_(thesis|corrected)", "displacement_slope", 1.9)),
        Bar(f"MMS {name.replace('_', ' ')}: slope of the stress (all cells), least-squares and corrected gradient", ">= 0.95",
            at_least(ORDER, f"/{name}_(thesis|corrected)", "stress_slope", 0.95, also="inner_stress_slope")))),
    Bar("Lame cylinder, plane strain and stress, quadrilaterals and triangles: slope of the displacement", ">= 1.9",
        at_least(CLOSED, "lame_cylinder_converges", "displacement_slope", 1.9, also="stress_slope")),
    Bar("Lame cylinder in a frictionless rigid wall: slope of the displacement", ">= 1.9",
        at_least(CLOSED, "rigid_wall", "displacement_slope", 1.9, also="stress_slope")),
    Bar("Kirsch hole, analytic tractions: slope of the stress", ">= 0.95", at_least(CLOSED, "kirsch", "stress_slope", 0.95)),
    Bar("Kirsch hole: hoop stress on the faces of the hole, part of 3 T", "<= 2 %",
        at_most(CLOSED, "kirsch", "hoop_stress_error_at_hole", 0.02)),
    Bar("Two materials, oblique interface, piecewise linear field: displacement", "exact to 1e-10",
        at_most(MATERIALS, "piecewise_linear", "relative_error", 1e-10)),
    Bar("Two materials: jump of the traction at the bonded faces", "<= 1e-10 of the stress",
        at_most(MATERIALS, "piecewise_linear", "relative_traction_jump", 1e-10)),
    Bar("Two materials in series: forces at both ends, least-squares gradient", "equal to 1e-9",
        all_pass(MATERIALS, "both_ends.*thesis", 6)),
    Bar("Two materials in series: forces at both ends, corrected gradient", "equal to 1e-8",
        all_pass(MATERIALS, "both_ends.*corrected", 6)),
    Bar("Layered cylinder (Lame): slope of the displacement", ">= 1.9",
        at_least(MATERIALS, "layered_cylinder", "displacement_slope", 1.9, also="stress_slope")),
    Bar("Rigid motion without stress, all cell types", "stress <= 1e-8 of that of an equal strain",
        at_most(PATCH, "small_rigid_rotation", "relative_stress", 1e-8)),
    Bar("Linear fields under every condition, all cell types", "exact to 1e-10",
        at_most(CONDITIONS, CONDITIONS_EXACT, "relative_error", 1e-10)),
    Bar("Symmetry planes of any orientation: turned box against straight one", "equal to 1e-10",
        at_most(CONDITIONS, "any_orientation", "symmetry", 1e-10)),
    Bar("Patches, conditions and materials on 1, 2 and 3 ranks", "all pass",
        programs_pass("^verification_solid_(patch|conditions|materials)(_[23])?$", 9)),
    Bar("Floating static bodies: free rigid motions named", "all pass", all_pass(CONDITIONS, "FreeMotions", 5)),
    Bar("Wrong configurations and meshes", "clear errors, exit code 2", wrong_input),
]
