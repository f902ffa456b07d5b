# SPDX-License-Identifier: Apache-2.0
"""Bars of gmsh in a sandbox: crafted geometry, the process, the cache, expressions of a study."""
import json
import os

from validation.job import Bar
from validation.parts.trust.runs import gtests, tests


def crafted(job, count=500):
    """Geometry files written against the allowlist, with a gmsh that notes its starts and without bubblewrap."""
    program = next(p for p in (job.build / "tests").rglob("fuzz_geo") if p.is_file() and os.access(p, os.X_OK))
    file = job.scratch / "fuzz_geo.json"
    result = job.run(["env", f"COUPLET_FUZZ_COUNT={count}", program, f"--gtest_output=json:{file}"], 3600, cwd=job.scratch)
    if not file.exists():
        raise RuntimeError(f"fuzz_geo ended with code {result.returncode}: {result.stdout[-200:]}")
    found = json.loads(file.read_text())["testsuites"][0]["testsuite"]  # also: the copy that gmsh gets is meshed as the file itself
    test = next(t for t in found if t["name"].startswith("files_are_refused"))
    good = not any(t.get("failures") for t in found) and result.returncode == 0 and int(test["tried"]) >= count
    return (f"{test['tried']} tried: {test['refused']} refused before gmsh, {test['let_through']} let through without harm, slowest "
            f"{test['slowest']} s", good and float(test["slowest"]) < 5)


BARS = [
    Bar("500 crafted .geo, by the allowlist alone: gmsh never starts for a refused one, nothing outside the folder of the case, 5 s each", "none fails",
        crafted),
    Bar("... and every payload as it is; those files do what they say once --allow-commands is given", "tests pass",
        gtests("fuzz_geo", "every_payload", "a_trusted_case", "an_ordinary_geometry", "options_beside", "cleaned_copy")),
    Bar("every .geo of configs/ and tests/ is let through; files outside the folder, links included, are refused by name", "tests pass",
        gtests("unit_mesh_files", "every_geometry", "files_elsewhere", "commands_and_written", "no_comments")),
    Bar("a solver killed while gmsh is meshing: no gmsh after 5 s, with bubblewrap, without, under mpirun; limits, home, network, disk as promised",
        "test passes", tests("^kill_meshing$")),
    Bar("in bubblewrap nothing but the own folder can be written to, and there is no network; its end, home and clean environment", "tests pass",
        gtests("unit_mesh_files", "end_of_a_program", "its_folder", "with_bubblewrap", "trusted_program")),
    Bar("a cached mesh with another digest (a number changed, a foreign mesh, none) is made anew with one line", "test passes",
        gtests("unit_mesh", "another_digest", "truncated_cache")),
    Bar("study's 'exact' is an expression, not Python; 'python' stays in the folder of the case", "test passes", tests("^cases_study_arithmetic$")),
]
