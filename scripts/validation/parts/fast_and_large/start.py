# SPDX-License-Identifier: Apache-2.0
"""What small jobs pay before they compute: libraries, and processor time beside a program that only starts and ends MPI."""
import re
import shutil
import statistics

from couplet.runs import launch

EMPTY = """#include <mpi.h>
int main(int argc, char** argv) { MPI_Init(&argc, &argv); MPI_Finalize(); return 0; }
"""
TURNS = 15
HEAVY = re.compile(r"(lib(?:petsc|slepc|openblas|gmsh)\S*) => ")


def solid(job):
    """Folder of a cantilever of 1000 cells from a .msh of its own."""
    def make():
        folder = job.scratch / "small-solid"
        folder.mkdir()
        shutil.copy(job.root / "configs/cantilever/cantilever.geo", folder)
        job.done(["gmsh", "-3", "-setnumber", "n_length", "40", "-setnumber", "n_side", "5", "cantilever.geo", "-o", "mesh.msh"], cwd=folder)
        case = (job.root / "configs/cantilever/case.yaml").read_text().split("\n# scripts/study")[0]
        case = re.sub(r"^ *mesh-parameters:.*\n", "", case, flags=re.M).replace("cantilever.geo", "mesh.msh")
        (folder / "case.yaml").write_text(case)
        return folder
    return job.once(("small solid",), make)


def cpu(command, folder):
    return launch(command, folder / "start.log", folder).cpu


def phases(text):
    """Seconds of the run by its own account: in all, solve, accept_step, files."""
    account = {m[1]: float(m[2]) for m in re.finditer(r"^(\w+) +([\d.]+) +[\d.]+ %", text, re.M)}
    return account["total"], account["solve"], account["accept_step"], account["write_output"] + account["save"]


def beside_empty(job):
    folder = solid(job)
    (folder / "empty.c").write_text(EMPTY)
    job.run(["mpicc", "-O2", "empty.c", "-o", "empty"], cwd=folder)
    turns = []
    for _ in range(TURNS):
        empty, own = cpu([folder / "empty"], folder), cpu([job.build / "bin/solid_solver", "case.yaml"], folder)
        turns.append((empty, own, *phases((folder / "start.log").read_text())))
    middle = [statistics.median(values) for values in zip(*turns)]
    more = statistics.median(own - empty for empty, own, *_ in turns)
    return (f"{more:.3f} s more than {middle[0]:.3f} s, median of {TURNS} pairs; the run's own account: {middle[2]:.3f} s, of which solve {middle[3]:.3f}, "
            f"judgement of the answer {middle[4]:.3f}, files {middle[5]:.3f}"), more <= 0.04


def linked(job, *programs):
    """Libraries that take long to open, of programs that do not solve."""
    found = {p: sorted(set(HEAVY.findall(job.done(["ldd", job.build / "bin" / p]).stdout))) for p in programs}
    return "; ".join(f"{p}: {', '.join(names) or 'none'}" for p, names in found.items()), not any(found.values())
