# SPDX-License-Identifier: Apache-2.0
"""Bars of the solid's own audit."""
from validation.job import Bar
from validation.parts.solid.cases import le10_strips
from validation.parts.trust.runs import gtests

BARS = [
    Bar("LE10 over the half width of the strip that holds it, and its limit", "reported", lambda job: (le10_strips("corrected")(job)[0], None)),
    Bar("the advice of a solve that fails names another method, and that one solves", "test passes",
        gtests("verification_solid_methods", "the_advice_of_a_failed_solve", "names_method_iterations")),
    Bar("Cook at nu 0.49, two tetrahedra across a slender beam, undamped growth: the audit convicts", "tests pass",
        gtests("verification_solid_audit", "fires_on_cook", "fires_on_two_long", "fires_on_undamped", "stretched_tetrahedra")),
    Bar("the symmetric gradient and nu 1/3: the audit is silent", "tests pass", gtests("verification_solid_audit", "is_silent")),
    Bar("energies.csv: losses of dissipative schemes are never negative", "tests pass", gtests("verification_solid_energy", "never_show_a_gain")),
    Bar("a static step that cannot be solved fails on all ranks and leaves its state", "tests pass",
        gtests("verification_solid_contract", "fails_on_all_ranks")),
]
