# SPDX-License-Identifier: Apache-2.0
"""benchmarks/scaling counts what a program does of which all is known (known.cpp), and its bars fire and do not fire.
Usage: test_counts.py PROJECT KNOWN LIBRARY"""
import pathlib
import sys
import tempfile

ROOT, KNOWN, LIBRARY = map(pathlib.Path, sys.argv[1:])
sys.path.insert(0, str(ROOT / "benchmarks/scaling"))
import counts  # noqa: E402
import model  # noqa: E402


def job(scratch, ranks, *words):
    return counts.counted(["mpirun", "--oversubscribe", "-n", ranks, KNOWN, *words], scratch / "-".join(map(str, (ranks, *words))), LIBRARY)


def row(short, long, extra=6):
    programs = [tally["program"] for tally in long]
    return counts.row_of("known", "known", len(long), [counts.difference(a, b, extra, programs) for a, b in zip(short, long)], 1, 0.1)


def check(name, got, wanted):
    assert got == wanted, f"{name}: {got}, not {wanted}"


with tempfile.TemporaryDirectory() as folder:
    scratch = pathlib.Path(folder)
    short, long, gathering = job(scratch, 3, 4), job(scratch, 3, 10), job(scratch, 3, 10, "gathers")
check("messages of a run", short[0]["peers"], {"1": 12})
check("bytes of a run", short[0]["bytes"], 12 * 40)
check("collectives of a run", short[2]["collectives"], {"allreduce": 8, "bcast": 1})  # that on one rank does not count
known = row(short, long)
check("messages per step", known["messages"], 3)
check("bytes per step", known["bytes"], 3 * 40)
check("neighbours", known["neighbours"], 1)
check("reductions per step", known["reductions"], 2)  # the broadcast at the start cancels
check("gathers per step", known["gathers"], 0)

few = {**known, "ranks": 2}
check("bars of what is in order", counts.failures([few, known]), [])
(said,) = counts.failures([few, row(short, gathering)])
assert "gathers" in said, said
(said,) = counts.failures([few, {**known, "ranks": 16, "neighbours": 15}])
assert "all others" in said, said
check("bars of eight neighbours", counts.failures([few, {**known, "ranks": 16, "neighbours": 8}]), [])
for key, word in (("most_to_one", "messages to one neighbour"), ("reductions", "reductions per step")):
    (said,) = counts.failures([few, {**known, key: 3 * known[key] + 3}])
    assert word in said, said
    check(f"{word} that grow with the iterations", counts.failures([few, {**known, key: 3 * known[key] + 2, "iterations": 3}]), [])

# The model: without a cost of the network all is ideal; a latency costs, and more ranks more of it.
single = {**known, "ranks": 1, "seconds": 1.0, "cells": 1000, "dimension": 3}
many = {**known, "cells": 1000, "dimension": 3}
free = model.Network("free", 0, float("inf"), "")
check("efficiency of a free network", model.predict([single, many], free, 100, weak=True), 1)
slow = model.Network("slow", 1e-3, 1e9, "")
two, hundred = (model.predict([single, many], slow, n, weak=True) for n in (2, 100))
assert 0.9 < hundred < two < 1, (two, hundred)
print("in order")
