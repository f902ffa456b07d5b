# SPDX-License-Identifier: Apache-2.0
"""Bars of verdicts that act: severities, exit code 4, what is accepted, neglected effects as a channel of their own, and what compressibility does."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, tests

BARS = [
    Bar("a finding `wrong` ends with exit code 4, --accept and simulation.accept let it pass, unknown ids are refused", "pass",
        tests("^cli_findings_accept$")),
    Bar("opinions on neglected effects: plain --strict passes, --strict=effects fails, a small load passes both", "pass", tests("^cli_findings_strict$")),
    Bar("all programs of a coupled job end with exit code 4, the coupler's findings in its run.json", "pass", tests("^cli_findings_coupled$")),
    Bar("scenes: a folded mesh in the mover, an explicit step far beyond its limit, --explain of cases with motion", "refused or right",
        tests("^cli_findings_scenes$")),
    Bar("ten halvings for one cause end the run with it, other causes and calm times in between do not", "pass",
        gtests("unit_app", "ten_for_one_cause", "causes_that_differ", "never_grow_back", "only_numbers_differ")),
    Bar("SF6 at Mach 0.36 flagged by its own sound, air at 48 m/s not; by name, key, pressure; the flap's fluid is no air", "pass",
        tests("^cli_findings_sound$")),
    Bar("compressibility: Mach number, compliance over the stroke and time of waves each fire beyond and are silent below their limits", "pass",
        gtests("unit_effects", "judged_by_what_it_does", "is_that_of_a_key", "fluctuations_of_a_harmonic_motion", "walls_at_rest")),
    Bar("work of the two sides half apart, energy out of nothing as large as what was given: useless, and not before", "pass",
        gtests("unit_coupler", "half_of_the_work_is_apart")),
]
