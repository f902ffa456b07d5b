# SPDX-License-Identifier: Apache-2.0
"""Measures of gmsh in a sandbox: crafted geometry, the process, the cache, expressions of a study."""

def crafted(job, count=500):
    """Geometry files written against the allowlist, with a gmsh that notes its starts and without bubblewrap."""
    found, good = job.fuzz("fuzz_geo", count)  # also: the copy that gmsh gets is meshed as the file itself
    test = next(t for name, t in found.items() if name.startswith("files_are_refused"))
    good = good and int(test["tried"]) >= count
    return (f"{test['tried']} tried: {test['refused']} refused before gmsh, {test['let_through']} let through without harm, slowest "
            f"{test['slowest']} s", good and float(test["slowest"]) < 5)
