# SPDX-License-Identifier: Apache-2.0
"""Measures of gmsh in a sandbox: crafted geometry, the process, the cache, expressions of a study."""
import json
import os


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
