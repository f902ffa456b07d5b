# SPDX-License-Identifier: Apache-2.0
"""The 23 things to fix of "nothing wrong leaves with exit code 0", each with the rows of this table and the tests that check it.
`table()` is docs/validation/trust-items.md; a row states whether every name in it exists."""
import re

# item: (what, how quantities of rows begin, tests by name: a test of ctest, or Suite.test of gtest)
ITEMS = {
    1: ("a fluid alone segfaults on --restart", ("every participant alone",), ("contract_fluid", "contract_fluid_3")),
    2: ("what can fail, fails in solve; state n stays", ("a fluid step that fails",), ("EnergyGuard.an_explicit_viscous_term_beyond_its_limit_fails_by_name_and_leaves_level_n",)),
    3: ("blow-ups that end well", ("explicit viscous term beyond", "flows driven hard", "a step without finite fluxes"),
        ("EnergyGuard.fluxes_out_of_all_bounds_are_named_by_field_cell_and_place", "EnergyGuard.too_many_sub_steps_are_named_by_cause_cell_and_place")),
    4: ("sheared, skewed and flat cells", ("sheared 55 to 75 degrees",), ("HardMeshes.sheared_by_seventy_degrees", "HardMeshes.needle_tetrahedra")),
    5: ("a mesh report; folded cells refused", ("every program with a mesh", "mesh report"), ("cli_mesh_report",)),
    6: ("closed fluids that must displace volume", ("a closed fluid whose interface",), ("coupling_cavity",)),
    7: ("divergence is named within a few passes", ("growth of the iteration", "two-step oscillations", "work of fluid and structure", "explicit flap at rho_s 42"),
        ("flap_explicit_added_mass_is_named", "flap_viscous_swing_holds_or_is_named")),
    8: ("interfaces elsewhere, staircases", ("surfaces elsewhere",), ()),
    9: ("balance of the explicit scheme", ("explicit balance",), ()),
    10: ("Cook at nu 0.49, two tetrahedra across a beam", ("Cook at nu 0.49", "the symmetric gradient and nu 1/3", "energies.csv"), ()),
    11: ("a static step that fails; advice", ("a static step that cannot", "the advice of a solve that fails"),
         ("SolidMethods.the_advice_of_a_failed_solve_is_another_method_and_that_one_solves", "cli_a_step_without_solution_ends_the_run")),
    12: ("LE10's strip of support", ("LE10 over",), ()),
    13: ("2^31 steps; right-hand sides that are not finite", ("3e9 steps", "krylov"), ()),
    14: ("checkpoints: latest, whole, same physics; SIGTERM; hangs",
         ("--restart takes", "keys and files that changed", "runs with no, one", "... fluid", "SIGTERM saves", "a process that is stopped", "2 000 damaged", "100 signals"),
         ("stop_and_go_on", "signals_on_the_flap")),
    15: ("only what this run wrote is overwritten or deleted", ("only what this run wrote", "participants named"), ()),
    16: ("geometry files that run commands; a case is code", ("a .geo that runs", "docs: a case is code"), ("Geo.commands_and_written_files_are_found",)),
    17: ("crashes and hangs of input", ("alias bombs", "a table from a FIFO", "an invalid number of cells", "a mesh cache that was cut", "hundreds of kilobytes of .geo"),
         ("Limits.anchors_that_multiply_are_refused_before_they_fill_the_memory", "Limits.brackets_in_units_are_counted",
          "Limits.control_characters_are_refused_with_their_place", "Limits.many_unknown_keys_are_counted_not_listed", "Table.from_a_fifo_is_refused_at_once",
          "LoadMesh.a_truncated_cache_is_made_anew", "LoadMesh.a_number_of_cells_that_is_none_is_refused",
          "Geo.hundreds_of_kilobytes_of_blanks_comments_names_and_brackets_end_nothing")),
    18: ("--check finds what it can", ("--check:",), ("cli_wrong_configurations",)),
    19: ("odd tanks", ("sun without a site", "a blanket of a micrometre", "porosity 1", "temperatures between sections", "coupled tank and wall"), ()),
    20: ("mutants, refusals, death tests, time limits, ParaView",
         ("mutants that survived", "real solvers killed", "time limits of the suite", "sheared 55 to 75 degrees", "ParaView"),
         ("cases_mutants_have_their_place", "kill_solvers", "cli_output_of_solid_opens_in_paraview", "cli_output_of_fluid_opens_in_paraview")),
    21: ("tables of bars", ("tables: what only reports",), ("cases_validation_tables_say_what_is_stale",)),
    22: ("house", ("house:",), ()),
    23: ("start-up", ("start-up",), ()),
}


def missing(root, bars, registered):
    """Names of ITEMS that are neither rows nor tests."""
    sources = "\n".join(f.read_text() for f in (root / "tests").rglob("*_test.cpp"))
    lost = []
    for number, (_, rows, tests) in ITEMS.items():
        lost += [f"{number}: row '{r}'" for r in rows if not any(b.quantity.startswith(r) for b in bars)]
        for test in tests:
            suite, _, claim = test.partition(".")
            there = re.search(rf"TEST(_P|_F)?\(\s*{suite},\s*{claim}\)", sources) if claim else test in registered
            lost += [] if there else [f"{number}: test '{test}'"]
    return lost


def table(bars):
    text = "# What each item of the trust issue is held by\n\nWritten by `scripts/validate trust --items`; rows are those of [trust.md](trust.md).\n\n| item | what | rows | tests |\n|---|---|---|---|\n"
    for number, (what, rows, tests) in ITEMS.items():
        named = [b.quantity for r in rows for b in bars if b.quantity.startswith(r)]
        text += f"| {number} | {what} | {'<br>'.join(named)} | {'<br>'.join(f'`{t}`' for t in tests)} |\n"
    return text


def complete(job):
    from validation import rows
    bars = rows.load("trust").bars
    registered = re.findall(r"^\s*Test\s+#\d+: (\S+)", job.run(["ctest", "--test-dir", job.build, "-N"]).stdout, re.M)
    lost = missing(job.root, bars, registered)
    committed = job.root / "docs/validation/trust-items.md"
    if not committed.exists() or committed.read_text() != table(bars):
        lost.append("docs/validation/trust-items.md is not what `scripts/validate trust --items` writes")
    return f"{len(ITEMS)} items" + (f"; not there: {'; '.join(lost)}" if lost else ", each with a row or a test"), not lost
