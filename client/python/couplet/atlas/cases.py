# SPDX-License-Identifier: Apache-2.0
"""The hard cases and their tests: mechanism, criterion, and the neighbouring case that fails. All are in tests/stability and have its
label; `missing` lists the names that do not exist (any more)."""
import dataclasses
import re


@dataclasses.dataclass
class Case:
    part: str
    name: str
    mechanism: str
    criterion: str
    holds: tuple  # "executable: Suite.test", or a script's name in ctest
    fails: tuple  # the neighbour, likewise


SOLID, FLUID = "stability_solid_hard_cases", "stability_fluid_step_sizes"
CASES = [
    Case("structure", "very short steps (elastic Courant number 0.01)", "an operator without symmetry makes a little energy each step",
         "energy within 1e-7 of the start's (4000 steps; 1e5 in the row)",
         (f"{SOLID}: SlowSwings.at_a_courant_number_of_a_hundredth_keep_their_energy_with_the_symmetric_gradient",),
         (f"{SOLID}: SlowSwings.grow_with_the_trapezoidal_rule_and_the_corrected_gradient",)),
    Case("structure", "very long steps (1000), Bathe", "a step that resolves nothing must not generate energy",
         "energy never above the start's by 0.1 %", (f"{SOLID}: FastSwings.at_a_courant_number_of_a_thousand_do_not_grow_with_bathes_scheme",),
         (f"{SOLID}: FastSwings.at_a_courant_number_of_ten_grow_with_the_trapezoidal_rule_and_the_thesiss_gradient",)),
    Case("structure", "steps that jump by 100", "the stored acceleration belongs to a past step", "energy kept to 1e-8",
         (f"{SOLID}: StepsThatJumpByAHundred.leave_the_energy_of_the_other_schemes_alone",),
         (f"{SOLID}: StepsThatJumpByAHundred.make_generalised_alpha_grow_and_the_run_ends_with_the_cause",)),
    Case("structure", "large strain under a partner's load", "the trapezoidal rule keeps what the coupling excites from step to step",
         "2 % of its energy left after 100 steps", (f"{SOLID}: PartnerVibration.dies_out_by_the_default_scheme",),
         (f"{SOLID}: PartnerVibration.stays_with_the_trapezoidal_rule",)),
    Case("structure", "cells of aspect 1000", "differences along the long side miss the bending between two cells",
         "pulled and bent as bars and beams, energy kept",
         (f"{SOLID}: CellsOfAspectAThousand.are_pulled_right_by_all_gradients_and_bent_the_right_way_by_the_symmetric_one",
          f"{SOLID}: CellsOfAspectAThousand.keep_the_energy_of_a_swing_with_the_symmetric_gradient"),
         (f"{SOLID}: CellsOfAspectAThousand.bend_wrongly_with_the_other_gradients_and_that_is_told",)),
    Case("structure", "stiffness that jumps by 1e6", "a gradient taken across the jump is that of neither side", "energy kept, stretched as two springs",
         (f"{SOLID}: StiffnessThatJumpsByAMillion.keeps_the_energy_of_a_swing_with_the_symmetric_gradient",
          f"{SOLID}: StiffnessThatJumpsByAMillion.is_stretched_as_two_springs_in_a_row"),
         (f"{SOLID}: StiffnessThatJumpsByAMillion.grows_with_the_thesiss_gradient_on_leaning_cells_and_the_run_ends",)),
    Case("structure", "thermal shock", "a rule without damping turns what it does not resolve round in each step", "no temperature outside of its bounds",
         (f"{SOLID}: ThermalShock.does_not_oscillate_with_eulers_scheme_whatever_the_step",),
         (f"{SOLID}: ThermalShock.swings_by_half_and_more_with_the_trapezoidal_rule_and_that_is_told_once",)),
    Case("fluid", "under-resolved vortices of Taylor and Green", "energy at the finest cells is not dissipated",
         "never gains energy in 20 turnovers (eighth of 16^3 and less; 32^3 in the rows)",
         ("stability_fluid_under_resolved: UnderResolved.vortices_never_gain_energy_in_twenty_turnovers_at_any_reynolds_number",),
         ("stability_fluid_under_resolved: UnderResolved.vortices_with_steps_beyond_the_limit_are_refused_by_name",)),
    Case("fluid", "viscous step just under its limit", "explicit diffusion beyond the largest eigenvalue", "noise decays at the limit",
         (f"{FLUID}: StepLimit.of_explicit_diffusion_is_the_longest_stable_step", "stability_fluid_energy_guard: EnergyGuard.the_same_flow_within_the_limit_goes_through"),
         ("stability_fluid_energy_guard: EnergyGuard.an_explicit_viscous_term_beyond_its_limit_fails_by_name_and_leaves_level_n",)),
    Case("fluid", "Courant number just under its limit, closed cavity", "explicit convection outside of the scheme's region",
         "steady flow, slower than the lid; at 1.3 of the limit it is not", (f"{FLUID}: StepLimit.of_a_cavity_keeps_it_steady_and_leaves_less_than_a_third_unused",),
         (f"{FLUID}: FixedStep.beyond_the_stability_limit_is_a_failure_that_names_the_place",)),
    Case("fluid", "backflow through an outlet", "inflow brings kinetic energy that no work supplies", "speed below that of the pressure's work",
         ("stability_fluid_under_resolved: Backflow.stays_bounded_by_the_work_of_the_pressure",),
         ("stability_fluid_under_resolved: Backflow.goes_beyond_it_without_the_stabilisation",)),
    Case("coupling", "closed fluid whose wall must displace volume", "only the wall can give way to what is pumped in",
         "volume error of a step 1e-10 of the inflow; refused without the level", ("coupling_cavity",), ("coupling_cavity",)),
    Case("coupling", "explicit coupling at its limit", "the structure feels the fluid's inertia a step late",
         "bounded below a mass ratio of 1 (1/3 with the predictor of order 2), grows above by the ratio",
         ("coupling_added_mass: AddedMass.explicit_coupling_is_bounded_below_a_mass_ratio_of_one",),
         ("coupling_added_mass: AddedMass.explicit_coupling_grows_by_the_mass_ratio_each_step",)),
    Case("coupling", "implicit, mass over added mass 0.01 to 100", "the iteration grows by the mass ratio where nothing relaxes it",
         "Aitken and quasi-Newton converge in each step (200 passes at most)", ("coupling_added_mass: AddedMass.map_of_mass_ratio_and_scheme",),
         ("coupling_added_mass: AddedMass.plain_iteration_diverges_above_a_mass_ratio_of_one",)),
    Case("coupling", "light wall in a viscous fluid", "friction at a predicted velocity oscillates with a period of two steps", "moves smoothly",
         ("stability_fluid_light_wall: LightWall.of_a_fortieth_of_the_added_mass_moves_smoothly", "stability_fluid_light_wall: Renewal.holds_a_wall_of_less_mass_than_the_layer_that_it_drags"),
         ("stability_fluid_light_wall: Renewal.such_a_wall_grows_without_it_and_with_one_only",)),
    Case("tank", "10 years of hourly weather", "errors of the energy balance accumulate", "energy balance to 1e-9, a year like the one before to 1e-3 (long)",
         ("stability_thermocline_ten_years", "stability_thermocline_hard_cases: EnergyBalance.three_months_of_daily_cycles_close"), ()),
    Case("tank", "sharp front, reversal in each step, rest", "a scheme of higher order overshoots at a front", "within the temperatures that went in, heat kept to 1e-10",
         tuple(f"stability_thermocline_hard_cases: HardCase.{name}" for name in ("sharp_front", "reversal_every_step", "rest_with_a_sharp_profile")),
         ("stability_thermocline_hard_cases: Overstepped.upwind_far_beyond_its_limit_leaves_the_bounds",)),
    Case("tank", "ratcheting over 3650 cycles", "grains settle a little in each cycle", "wall's load between the active and the passive, no drift",
         ("stability_thermocline: Ratcheting.of_3650_equal_cycles_is_bounded_and_the_same_from_the_second_on",
          "stability_thermocline: Ratcheting.of_3650_scattered_cycles_stays_between_the_active_and_the_passive_load"),
         ("stability_thermocline: Ratcheting.of_a_filler_that_does_not_slide_passes_that_load",)),
    Case("plate", "bounces on a seat", "a contact met and left within a step adds energy", "the conserving rule keeps it whatever stiffness and step",
         ("stability_plate_contact: PlateContactMap.conserving_holds_over_stiffness_and_step_and_midpoint_does_not",),
         ("stability_plate_contact: PlateContactMap.conserving_holds_over_stiffness_and_step_and_midpoint_does_not",)),
]


def missing(root):
    """Names of the table that tests/stability does not have with its label."""
    folder, lost = root / "tests/stability", []
    lists = {f: f.read_text() for f in folder.glob("*/CMakeLists.txt")}
    for case in CASES:
        for name in (*case.holds, *case.fails):
            executable, _, test = name.partition(": ")
            home = next((f.parent for f, text in lists.items() if re.search(rf"NAME\s+{executable}\b[^)]*LABELS[^)]*\bstability\b", text)), None)
            suite, _, claim = test.partition(".")
            there = home and (not test or any(re.search(rf"TEST(_P|_F)?\(\s*{suite},\s*{claim}\)", f.read_text()) for f in home.glob("*_test.cpp")))
            if not there:
                lost.append(name)
    return lost


def page():
    text = "\n## Hard cases\n\nAs tests in `tests/stability` (label `stability`), each with its failure mechanism, its criterion, and a neighbouring case that fails.\n\n"
    text += "| part | case | mechanism | criterion | tested by | failing neighbour |\n|---|---|---|---|---|---|\n"
    tests = lambda names: "<br>".join(f"`{n.split(': ')[-1]}`" for n in names)
    for c in CASES:
        text += f"| {c.part} | {c.name} | {c.mechanism} | {c.criterion} | {tests(c.holds)} | {tests(c.fails)} |\n"
    return text
