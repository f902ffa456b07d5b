#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/couplet study --quantities: parts of the error from runs that are made up, what is made coarser in cases of several kinds, and, with
a build, Cook's membrane beside its converged reference.  Usage: study_interest.py [BUILD]"""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "client/python"))
from couplet.runs import Case  # noqa: E402
from couplet.study import interest  # noqa: E402

MESH = interest.Source("mesh", None, False, 2, 2)


def part(order, n=32, sign=1):
    """Of values 5 + 3 n^-order at n, n/2 and n/4."""
    return of_mesh(*(5 + sign * 3 * m**-order for m in (n, n / 2, n / 4)))


def of_mesh(own, coarser, coarsest=None):
    return interest.parts_of({"as-it-is": own, "mesh coarser": coarser, **({} if coarsest is None else {"mesh coarsest": coarsest})}, [MESH])


# -- the order is observed, so that the estimate is the true error; beyond the bounds it is that of the bound
for order in (0.7, 1.0, 1.6, 2.0):
    for sign in (1, -1):
        parts, orders = part(order, sign=sign)
        assert abs(orders["mesh"] - order) < 1e-6 and abs(parts["mesh"] - 3 * 32**-order) < 1e-9, (order, parts, orders)
assert part(3.5)[1]["mesh"] == 2 and part(0.2)[1]["mesh"] == interest.LEAST_ORDER
# -- no order where the values change direction or the coarsest run is missing: the formal one
assert abs(of_mesh(1.0, 1.3, 1.1)[0]["mesh"] - 0.1) < 1e-12 and abs(of_mesh(1.0, 1.3)[0]["mesh"] - 0.1) < 1e-12
# -- what dominates: value = 1 + mesh + step + what two solvers leave, in turn the largest
SOURCES = [interest.source_of(name, given, "file") for name, given in {
    "mesh": {"size": 16, "set": {"n": "<n>"}}, "step": {"key": "dt", "value": 0.1}, "solver": {"key": "tol", "value": 1e-5, "tolerance": True},
    "coupling": {"key": "passes", "value": 1e-4, "tolerance": True}}.items()]
for worst in ("mesh", "step", "solver", "coupling"):
    true = {s.name: (1e-2 if s.name == worst else 1e-4) for s in SOURCES}

    def value(factors):
        s = {k: float(v) for source in SOURCES for k, v in source.changes(factors.get(source.name, 1)).items()}
        return 1 + true["mesh"] * (16 / s["n"])**2 + true["step"] * (s["dt"] / 0.1)**2 - true["solver"] * s["tol"] / 1e-5 - true["coupling"] * s["passes"] / 1e-4
    parts, _ = interest.parts_of({name: value(factors) for name, factors in interest.runs_of(SOURCES).items()}, SOURCES)
    assert max(parts, key=parts.get) == worst and all(0.5 < parts[k] / true[k] < 2 for k in true), (worst, parts)
    assert f"the {worst} dominates" in interest.advice(parts) and "would not help" in interest.advice(parts)
# -- what is made coarser
mesh, = interest.sources_of(Case(ROOT / "configs/cook/case.yaml"), "solid")
assert mesh.name == "mesh" and mesh.changes(1) == {"mesh-parameters": "{n: 16, shape: 0}"} and mesh.changes(2) == {"mesh-parameters": "{n: 8, shape: 0}"}
step, = interest.sources_of(Case(ROOT / "configs/vibrating-cantilever/case.yaml"), "solid")
# -- from what the study and --set make of the case, not from what its file says
finer, = interest.sources_of(Case(ROOT / "configs/cook/case.yaml"), "solid", {"participants.solid.mesh-parameters": "{n: 32, shape: 0}"})
assert finer.changes(1) == {"mesh-parameters": "{n: 32, shape: 0}"} and finer.changes(2) == {"mesh-parameters": "{n: 16, shape: 0}"}
longer, = interest.sources_of(Case(ROOT / "configs/vibrating-cantilever/case.yaml"), "solid", {"simulation.time-step": "0.5 s"})
assert longer.changes(2)["simulation.time-step"] == 1
assert step.name == "step" and step.changes(2)["simulation.time-step"] == 2 * step.changes(1)["simulation.time-step"]

# -- a setting that the sources would override is refused, not ignored
done = subprocess.run([sys.executable, ROOT / "scripts/couplet", "study", ROOT / "configs/taylor-green-2d/case.yaml", "--quantities", "--set", "simulation.time-step=0.01"],
                      capture_output=True, text=True, timeout=60)
assert done.returncode != 0 and "study.sources sets this key itself" in done.stdout + done.stderr, done

if len(sys.argv) > 1:
    with tempfile.TemporaryDirectory(prefix="couplet-interest-") as folder:
        done = subprocess.run([sys.executable, ROOT / "scripts/couplet", "study", ROOT / "configs/cook/case.yaml", "--quantities", "--out", folder, "--build", sys.argv[1]],
                              capture_output=True, text=True, timeout=280)
        assert done.returncode == 0, done.stdout + done.stderr
        found = json.loads((pathlib.Path(folder) / "quantities/quantities.json").read_text())["displacement of the corner"]
    true = 0.0323007 - found["value"]
    print(f"Cook's corner: estimated error {found['error']:.3g} m, true {true:.3g} m")
    assert 0.5 < found["error"] / true < 2
print("ok")
