# SPDX-License-Identifier: Apache-2.0
"""Bars of the symmetric operator itself: symmetry, positivity, patch test, energy; and of the guards that judge a run."""
from validation.job import Bar
from validation.parts.measures import all_pass, at_least, at_most, programs_pass

SYMMETRIC, PATCH, AUDIT = "verification_solid_symmetric", "verification_solid_patch", "verification_solid_audit"
ORTHOTROPIC = "verification_solid_orthotropic"
ORDER = "verification_solid_order"
KINDS = ("quadrilaterals", "triangles", "hexahedra", "tetrahedra", "prisms", "mixed")


def keys(stem, kinds=KINDS):
    return " ".join(f"{stem}_{kind}" for kind in kinds)


def within(pattern, names, limit):
    """Recorded relative errors, both signs."""
    def measure(job):
        found = [job.recorded(SYMMETRIC, pattern, name) for name in names.split()]
        values = [v for got, _ in found for v in got]
        return ", ".join(f"{100 * v:+.2f} %" for v in values), all(ok for _, ok in found) and all(abs(v) <= limit for v in values)
    return measure


def closed_form(pattern, names=("quadrilaterals", "triangles")):
    """Errors (and orders) against a closed form that a test records as text."""
    def measure(job):
        tests, _ = job.gtest(ORTHOTROPIC, f"*{pattern}*")
        text = "; ".join(f"{name}: {test[name]}" for test in tests.values() for name in names)
        return text, all(test["passed"] for test in tests.values())
    return measure


def manufactured(kinds, key, least):
    """Slopes of the manufactured solution on these cells."""
    def measure(job):
        found = [job.recorded(ORDER, f"OnAnEnergy.*/{kind}_symmetric", key) for kind in kinds]
        values = [v for got, _ in found for v in got]
        return ", ".join(f"{v:.2f}" for v in values), all(ok for _, ok in found) and all(v >= least for v in values)
    return measure


EVEN, REST = ("hexahedra", "quadrilaterals"), ("tetrahedra", "prisms", "mixed", "triangles")
BARS = [
    Bar("manufactured solution, six kinds of cells: slope of the displacement", ">= 1.9",
        manufactured(EVEN + REST, "displacement_slope", 1.9), long=True),
    Bar("the same on hexahedra, quadrilaterals: slope of the stress", ">= 1.8", manufactured(EVEN, "stress_slope", 1.8), long=True),
    Bar("the same on tetrahedra, prisms, mixed cells, triangles: slope of the stress", ">= 1.3", manufactured(REST, "stress_slope", 1.3), long=True),
    Bar("the same, vertices moved by a fifth, six kinds: slope of the displacement", ">= 1.9",
        manufactured([f"perturbed_{k}" for k in EVEN + REST], "displacement_slope", 1.9), long=True),
    Bar("the same: slope of the stress", "reported: the issue names no mesh", lambda job: (
        manufactured([f"perturbed_{k}" for k in EVEN + REST], "stress_slope", 0)(job)[0], None), long=True),
    Bar("symmetry |v.Ku - u.Kv| under every condition, six kinds of cells, vertices moved by a quarter", "<= 1e-13",
        at_most(SYMMETRIC, "is_symmetric", keys("asymmetry"), 1e-13)),
    Bar("smallest eigenvalue of M^-1 K, cells stretched 10:1 and two across, six kinds", "> 0",
        at_least(SYMMETRIC, "positive_eigenvalues", keys("smallest"), 1e-300, text="{:.2e}"),
        but="vertices moved by 5 % of their cells, since 20 % folds cells that thin"),
    Bar("patch tests, six kinds of cells, vertices moved by a quarter", "exact to 1e-10", all_pass(PATCH, "_symmetric", 30)),
    Bar("half the work of the loads and the strain energy, six kinds", "equal to 1e-10", all_pass(SYMMETRIC, "half_the_work")),
    Bar("undamped trapezoidal rule, perturbed meshes of five kinds, 60 steps: drift of the energy", "< 1e-9",
        at_most(SYMMETRIC, "keeps_its_energy", keys("drift", KINDS[:5]), 1e-9), but="60 steps; the row below has 1e5"),
    Bar("the same, 1e5 steps of 0.01 and 0.001 s, six kinds: largest drift at any time", "< 1e-9",
        at_most("verification_solid_undamped", "keeps_its_energy", f"{keys('long')} {keys('short')}", 1e-9), long=True,
        but="bodies of 8 to 96 cells"),
    Bar("beam 10:1, nu 0.3, hexahedra 20x2x2: tip", "within 1 %", within("few_hexahedra", "cubes", 0.01)),
    Bar("beam 10:1, hexahedra 5x2x2 and 4x4x4: tip", "within 6 and 10 %", all_pass(SYMMETRIC, "few_hexahedra")),
    Bar("beam 10:1, six tetrahedra per cube, two across: tip", "within 2 %", within("few_tetrahedra", "two_across_tetrahedra", 0.02)),
    Bar("beam 10:1, prisms two across: tip", "within 7 %", within("few_tetrahedra", "two_across_prisms", 0.07)),
    Bar("1, 2 and 3 ranks", "all pass", programs_pass("^verification_solid_symmetric(_2|_3)?$", 3)),
    Bar("a run flags Cook's membrane at nu 0.49 with the corrected gradient and not with the symmetric one", "fires and is silent",
        all_pass(AUDIT, "cook", 2)),
    Bar("a run flags two long tetrahedra across a beam of 40:1 and not four cubes across", "fires and is silent",
        all_pass(AUDIT, "two_long_tetrahedra")),
    Bar("a run flags undamped motion that grows, and not that of the symmetric gradient", "fires and is silent",
        all_pass(AUDIT, "grows_out_of_nothing")),
    Bar("orthotropic: constant strain in turned axes, six kinds of cells, vertices moved by a quarter", "exact to 1e-10",
        all_pass(ORTHOTROPIC, "constant_strain", 6)),
    Bar("orthotropic: bar cut off-axis, pulled: stretch and shear of the closed form", "exact to 1e-10", closed_form("stretches_and_shears")),
    Bar("orthotropic: bar cut off-axis, bent by a moment, 64x16", "closed form, order >= 1.8", closed_form("bends_as_its")),
    Bar("orthotropic: ring with axes along its circles under inner pressure, 16 across", "closed form, order >= 1.8",
        closed_form("a_ring", ("ring",))),
    Bar("orthotropic: 1, 2 and 3 ranks", "all pass", programs_pass("^verification_solid_orthotropic(_2|_3)?$", 3)),
]
