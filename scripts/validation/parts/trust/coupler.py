# SPDX-License-Identifier: Apache-2.0
"""Bars of the coupler: closed fluids, divergence by name, places, the explicit scheme's balance."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, tests

BARS = [
    Bar("a closed fluid whose interface must displace volume: refused at the start, and when it is pumped up", "tests pass",
        gtests("contract_fluid", "ClosedFluid.whose_interface", "ClosedFluid.that_is_pumped_up")),
    Bar("growth of the iteration is named within a few passes and not halved; slow convergence passes", "tests pass",
        gtests("unit_coupler", "IterationGuard")),
    Bar("two-step oscillations and added-mass growth are named with a stable scheme; smooth motion passes", "tests pass",
        gtests("unit_coupler", "OscillationGuard")),
    Bar("work of fluid and structure that part is named; small steps and turning points pass", "tests pass",
        gtests("unit_coupler", "WorkGuard")),
    Bar("explicit flap at rho_s 42: refused with the added mass as the reason", "test passes", tests("^flap_explicit_added_mass_is_named$")),
    Bar("explicit balance: each side's work is that of its own wall; the run ends with a verdict", "tests pass",
        gtests("unit_coupler", "each_side_counts_the_way_of_its_own_wall", "convicted_at_the_end")),
    Bar("surfaces elsewhere or of another size refused, staircases reported, loads that are not finite caught", "tests pass",
        gtests("unit_coupler", "Places")),
]
