# SPDX-License-Identifier: Apache-2.0
"""Bars of roles as contracts: who may play what, surfaces that move together, structures that stand still, waits in a circle,
signs of life."""
from validation.job import Bar
from validation.parts.trust.runs import gtests, script

ROLES = "tests/coupling/roles/roles.py"
WALLS = "tests/coupling/roles/walls.py"

BARS = [
    Bar("roles of the flap by --check alone: all 27 ways to give three roles to three participants, by every program of the case",
        "all but the right one refused, exit code 2", script(ROLES, "{bin}", "{root}/configs", "check")),
    Bar("24 permutations of the programs over coupler, fluid, structure and mesh of the flap, with and without the YAML permuted "
        "along, and 27 assignments of the roles, started",
        "refused by name at the roll call, or the right answer", script(ROLES, "{bin}", "{root}/configs", "launch"), long=True),
    Bar("every exchange of two roles of the two flaps", "refused by name at the roll call, or the right answer",
        script(ROLES, "{bin}", "{root}/configs", "flaps"), long=True),
    Bar("contracts: units, places, components; each program plays its roles and no other", "all claims hold",
        gtests("unit_start_checks", "RoleContracts")),
    Bar("surfaces that move together: area, centroid, first moments, bounding box; meshes of one surface (8 chords of a circle "
        "among them) pass, 5 % larger or 5 % aside do not", "all claims hold", gtests("unit_start_checks", "Surfaces")),
    Bar("a load and no motion for ten steps", "flagged once; not where it moves by however little, nor without a load",
        gtests("unit_start_checks", "StillGuard")),
    Bar("the flap with a solid 5 % larger, with the mover's patch fixed (by --check and at the start), and held",
        "flagged or refused with the number; the case as it is: no finding of these", script(WALLS, "{bin}", "{root}/configs", "flap")),
    Bar("start of every shipped coupled case: surfaces and mover", "0 findings",
        script(WALLS, "{bin}", "{root}/configs", "shipped"), long=True),
    Bar("a wait in a circle, hang-timeout by default, 0 and 1 h; a process without a sign of life and a stopped one; seven seconds "
        "of work with signs of life beyond a hang-timeout of 3 s",
        "named within 10 s; named; no finding", script("tests/cli/death/silence.py", "{bin}", "{bin}/tests"), long=True),
    Bar("hang-timeout that a case does not give", "600 s", script(WALLS, "{bin}", "{root}/configs", "timeout")),
]
