# SPDX-License-Identifier: Apache-2.0
"""benchmarks/linalg on small systems: all solvers reach the tolerance and the same solution; and its verdicts can fail.
Usage: linear_solvers.py BUILD"""
import importlib.machinery
import importlib.util
import pathlib
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parents[3] / "benchmarks/linalg"
loader = importlib.machinery.SourceFileLoader("race", str(HERE / "run"))
race = importlib.util.module_from_spec(importlib.util.spec_from_loader("race", loader))
sys.dont_write_bytecode = True
loader.exec_module(race)
import tables  # noqa: E402

FLUID = ("simulation.end-time=0.05", "participants.fluid.mesh-parameters.n=24")
SMALL = {"fluid 2-D": ("matrix", "oscillating-cylinder", FLUID, (), 2),
         "plate B": ("solid", "elliptic-plate", (race.S + "mesh-parameters={nr: 4, nt: 6, nz: 3, shape: 0}",), (), 0),
         "nu 0.4999": ("solid", "elliptic-plate", (race.S + "mesh-parameters={nr: 4, nt: 6, nz: 3, shape: 0}", race.S + "material.poissons-ratio=0.4999",
                                                   race.S + "solution-method={preconditioner: mixed}"), (), 0)}
TRIED = {("fluid 2-D", 1): ("CHOLMOD", "CG, GAMG", "its own Cholesky"), ("fluid 2-D", 2): ("CG, GAMG", "MUMPS"),
         ("plate B", 1): ("our krylov CG, component_multigrid", "PETSc CG, our", "GAMG by", "CG, GAMG", "MUMPS"), ("plate B", 2): ("our krylov CG, component_multigrid",),
         ("nu 0.4999", 1): ("the program", "GMRES(30)", "MUMPS")}


def agree(build):
    race.SYSTEMS.update(SMALL)
    with tempfile.TemporaryDirectory() as folder:
        one = race.Race(build, pathlib.Path(folder))
        for (system, ranks), words in TRIED.items():
            one.record(system, ranks, False)
            for name, how in race.solvers_of(system).items():
                if not any(w in name for w in words):
                    continue
                found = one.measure(system, ranks, False, how)
                assert "failure" not in found, (system, ranks, name, found)
                # The recorded tolerance of the fluid is 1e-4 or looser, of the right-hand side.
                least = 1e-2 if system == "fluid 2-D" else 1e-7
                assert 0 <= found["error"] < least and found["residual"] <= 1.1 and found["iterations"] >= 1, (system, ranks, name, found)
        bad = one.measure("fluid 2-D", 1, False, "petsc -ksp_type richardson -ksp_max_it 1 -pc_type none")
        assert "times the wanted one" in bad.get("failure", ""), bad


def verdicts_can_fail():
    rows = tables.read()
    assert not any("does not win" in p and "component_multigrid" in p for p in tables.problems(rows)), tables.problems(rows)
    slower = [dict(r, solve=str(10 * float(r["solve"])), setup=str(10 * float(r["setup"])), megabytes="1e6") if "our krylov CG, component_multigrid" == r["solver"] else r
              for r in rows]
    assert any(p.startswith("component_multigrid does not win") for p in tables.problems(slower)), "a slow solver passes"
    assert any(p == "slender: the program's own solver is missing" for p in tables.problems([r for r in rows if r["system"] != "slender"]))
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "my_solver.hpp").write_text("")
        assert tables.problems(rows, pathlib.Path(folder))[-1] == "my_solver has no row"


verdicts_can_fail()
agree(pathlib.Path(sys.argv[1]).resolve())
