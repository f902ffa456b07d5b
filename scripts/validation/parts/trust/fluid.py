# SPDX-License-Identifier: Apache-2.0
"""Bars of the fluid: restart alone, what fails fails in solve, energy budget, hard meshes, the mesh report."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, tests

BARS = [
    Bar("every participant alone: restart, failure and ranks (contract suite)", "tests pass", tests("^contract_(solid|fluid|thermocline|plate)", 10)),
    Bar("a fluid step that fails leaves state n bit for bit", "tests pass",
        gtests("verification_fluid_steps", "leaves_the_accepted_state_alone") ),
    Bar("explicit viscous term beyond its limit: fails by name; the neighbour within it goes through", "tests pass",
        gtests("stability_fluid_energy_guard", "fails_by_name_and_leaves_level_n", "within_the_limit_goes_through")),
    Bar("flows driven hard stay below a third of the energy guard's threshold", "tests pass",
        gtests("stability_fluid_energy_guard", "stays_below_a_third")),
    Bar("sheared 55 to 75 degrees, slivers, needles, cells of aspect 1000: solved, or refused with the number", "tests pass",
        gtests("stability_fluid_step_sizes", "sheared_by_seventy", "sheared_by_55", "sheared_by_75", "needle", "slivers", "thousand_times"),
        but="wall cells of aspect 1e3 in the test; 1e5 is a row of moving-mesh"),
    Bar("a step without finite fluxes and one of too many sub-steps name field, cell and place", "tests pass",
        gtests("stability_fluid_energy_guard", "out_of_all_bounds", "too_many_sub_steps")),
    Bar("every program with a mesh reports it in one line with places, and refuses a folded one by cell and place", "test passes",
        tests("^cli_mesh_report$")),
    Bar("mesh report: the worst of each kind and its place; crossed and inverted cells are named", "tests pass",
        gtests("unit_mesh", "worst_of_each_kind", "crosses_itself", "names_the_worst_cell")),
]
