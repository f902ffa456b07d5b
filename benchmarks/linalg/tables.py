# SPDX-License-Identifier: Apache-2.0
"""table.csv of benchmarks/linalg and what is made of it: the tables of README.md, and whether each hand-written solver wins by a third."""
import csv
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
COLUMNS = ("system", "size", "ranks", "unknowns", "solver", "iterations", "setup", "solve", "reuse", "megabytes", "tolerance", "residual", "error",
           "turns", "note")
SYSTEMS = ("fluid 2-D", "fluid 3-D", "plate B", "tetrahedra", "nu 0.4999", "slender")
WINS = 0.75  # time or memory over those of PETSc's best, which then takes a third more
LEAST_MEGABYTES = 30  # below that what differs is PETSc's own objects, whatever the size of the system
LEFT = 20  # residual over the wanted one: rounding of the slender beam's operator leaves 7 to all solvers
PETSC = ("GAMG", "BoomerAMG", "MUMPS")
# Solvers of common/linalg: row of Couplet, part of the names of PETSc's rows instead of it, and the systems in
# which the programs use it.
HAND_WRITTEN = {
    "component_multigrid": ("our krylov CG, component_multigrid", lambda name: "component_multigrid" not in name, ("plate B", "tetrahedra", "slender")),
}
# Other files of that folder: interfaces to PETSc, MUMPS and LAPACK, and files without a linear solver.
NOT_SOLVERS = ("acceleration", "cell_solver", "dense_eigenvalues", "krylov", "linear_solver", "matrix", "petsc", "residual_projection", "symmetric_factors")
BEGIN, END = "<!-- tables -->", "<!-- end of tables -->"


def read(path=HERE / "table.csv"):
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def solved(row):
    return bool(row["solve"]) and float(row["residual"]) < LEFT


def seconds(row):
    """One making of the preconditioner and its solves, a solve."""
    return float(row["setup"]) / float(row["reuse"]) + float(row["solve"])


def gains(rows, name):
    """Returns [(time over that of PETSc's quickest, memory over that of its leanest, our row)] of a hand-written solver; memory: infinity where there is
    too little to tell."""
    ours, is_rival, systems = HAND_WRITTEN[name]
    found = []
    for row in rows:
        if row["solver"] != ours or row["system"] not in systems or not solved(row):
            continue
        rivals = [r for r in rows if all(r[k] == row[k] for k in ("system", "size", "ranks")) and r["solver"] != ours and is_rival(r["solver"]) and solved(r)]
        if rivals:
            leanest = min(float(r["megabytes"]) for r in rivals)
            memory = float(row["megabytes"]) / leanest if leanest > LEAST_MEGABYTES else float("inf")
            found.append((seconds(row) / min(map(seconds, rivals)), memory, row))
    return found


def best(rows, name):
    """Returns the best row on one rank. On two ranks the time would include one rank waiting for the other."""
    return min((g for g in gains(rows, name) if g[2]["ranks"] == "1"), key=lambda g: min(g[:2]), default=None)


def wins(rows, name):
    found = best(rows, name)
    return found is not None and min(found[:2]) <= WINS


def problems(rows, folder=ROOT / "common/linalg"):
    """Returns the gaps of the comparison. Empty if it is complete and every hand-written solver that still exists wins."""
    found = []
    for system in SYSTEMS:
        here = [r for r in rows if r["system"] == system]
        done = [r for r in here if solved(r)]
        if not any(w in r["solver"] for r in done for w in ("our ", "PETSc CG, ML", "the program")):
            found.append(f"{system}: the program's own solver is missing")
        found += [f"{system}: {word} is missing" for word in PETSC if not any(word in r["solver"] for r in here)]
        found += [f"{system}: nothing on {ranks} ranks" for ranks in ("1", "2") if not any(r["ranks"] == ranks for r in done)]
    for file in sorted(folder.rglob("*.hpp")):
        if file.stem in NOT_SOLVERS:
            continue
        if file.stem not in HAND_WRITTEN:
            found.append(f"{file.stem} has no row")
        elif not wins(rows, file.stem):
            gain = best(rows, file.stem)
            found.append(f"{file.stem} does not win by a third" + (f" ({min(gain[:2]):.2f} of PETSc's best)" if gain else ""))
    return found


def verdicts(rows):
    yield "| solver | system | size | ranks | unknowns | time relative to PETSc's quickest solver | memory relative to PETSc's smallest |"
    yield "|---|---|---|---|---|---|---|"
    for name in HAND_WRITTEN:
        for time, memory, row in gains(rows, name):
            yield f"| {name} | {row['system']} | {row['size']} | {row['ranks']} | {row['unknowns']} | {time:.2f} | {f'{memory:.2f}' if memory < 1e300 else 'under 30 MB'} |"


def table_of(rows, system, size):
    here = [r for r in rows if r["system"] == system and r["size"] == size]
    for ranks in sorted({r["ranks"] for r in here}):
        group = [r for r in here if r["ranks"] == ranks]
        done = [r for r in group if solved(r)]
        if not done:
            continue
        first = done[0]
        base = seconds(first)
        reuse = f", {float(first['reuse']):.0f} solves per preconditioner" if float(first["reuse"]) > 1 else ""
        yield ""
        yield f"**{system}**, {first['unknowns']} unknowns, {ranks} rank{'s' if ranks != '1' else ''}, tolerance {float(first['tolerance']):.0e}{reuse}:"
        yield ""
        yield "| solver | iterations | set-up [s] | solve [s] | time | memory [MB] | residual over tolerance |"
        yield "|---|---|---|---|---|---|---|"
        for r in group:
            if not solved(r):
                yield f"| {r['solver']} | {r['note']} | | | | | |"
                continue
            yield (f"| {r['solver']} | {r['iterations']} | {float(r['setup']):.3g} | {float(r['solve']):.3g} | {seconds(r) / base:.2f} | "
                   f"{float(r['megabytes']):.3g} | {float(r['residual']):.2g} |")


def write_tables(rows):
    lines = [BEGIN, "", *verdicts(rows)]
    for size in ("quick", "large"):
        if any(r["size"] == size for r in rows):
            lines += ["", f"### {size.capitalize()} sizes", *(line for system in SYSTEMS for line in table_of(rows, system, size))]
    readme = HERE / "README.md"
    text = readme.read_text()
    before, rest = text.split(BEGIN)
    readme.write_text(before + "\n".join([*lines, "", END]) + rest.split(END)[1])
