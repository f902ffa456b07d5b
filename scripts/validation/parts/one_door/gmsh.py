# SPDX-License-Identifier: Apache-2.0
"""Measures of gmsh in a sandbox: crafted geometry, the process, the cache, expressions of a study."""

def crafted(job, count=500):
    """Geometry files written against the sandbox."""
    found, good = job.fuzz("fuzz_geo", count)  # also: gmsh makes the same meshes inside and outside
    test = next(t for name, t in found.items() if name.startswith("files_do_no_harm"))
    good = good and int(test["tried"]) >= count
    return f"{test['tried']} tried, none did harm, slowest {test['slowest']} s", good and float(test["slowest"]) < 5
