# SPDX-License-Identifier: Apache-2.0
"""Stress at surfaces, recovered from patches of cells."""
from validation.job import Bar
from validation.parts.right_by_default.scenes import probe

FILLET = 69.64e6  # CalculiX 2.20, 28 585 C3D10, the fillet refined; 9714 of them give 68.60


def fillet(h, within):
    def measure(job):
        run = job.solve_run("solid_solver", "filleted-bracket", (f"participants.solid.mesh-parameters={{h: {h}}}",))
        stress = probe(run, "fillet equivalent-stress [Pa]")
        return f"{stress / 1e6:.2f} MPa, {100 * (stress / FILLET - 1):+.1f} %", abs(stress / FILLET - 1) <= within
    return measure


def slope(kind):
    def measure(job):
        (found, *_), passed = job.recorded("verification_solid_order", rf"OnAnEnergy.*/{kind}_symmetric", "recovered_stress_slope")
        return f"{found:.2f}", passed and found >= 1.9
    return measure


NOTE = "the reference's last two meshes are 1.5 % apart, not 0.5 %"
BARS = [
    Bar("fillet, von Mises, 3114 tetrahedra", "within 10 % of 69.64 MPa", fillet(0.006, 0.10), but=NOTE),
    Bar("fillet, von Mises, 12 990 tetrahedra", "within 5 % of 69.64 MPa", fillet(0.0036, 0.05), but=NOTE),
    Bar("fillet, von Mises, 52 142 tetrahedra", "within 2.5 % of 69.64 MPa", fillet(0.0022, 0.025), but=NOTE),
    *(Bar(f"slope of the recovered stress at all points, {kind}", ">= 1.9", slope(kind))
      for kind in ("hexahedra", "prisms", "tetrahedra", "quadrilaterals", "triangles")),
]
