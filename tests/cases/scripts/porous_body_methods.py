# SPDX-License-Identifier: Apache-2.0
"""On a small porous body every solution method converges and gives the same force on 1 and 3 ranks.
Usage: porous_body_methods.py BUILD"""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
from validation.job import Job  # noqa: E402

CELLS = 10  # of the lattice: 5774 tetrahedra, of which ears hang on one face
MOST = {"newton-krylov": 150, "segregated": 250, "block-coupled": 400}  # iterations

with Job(ROOT, pathlib.Path(sys.argv[1]).resolve(), quick=True) as job:
    study = job.beside("configs/porous-body/study.py")
    for method, most in MOST.items():
        runs = [study.run(job, CELLS, ranks, method) for ranks in ((1, 3) if "newton" in method else (1,))]
        forces = [r["force"] for r in runs]
        print(method, forces, [r["iterations"] for r in runs])
        if max(forces) / min(forces) - 1 > 1e-5:
            sys.exit(f"{method}: the force depends on the number of ranks: {forces}")
        if max(r["iterations"] for r in runs) > most:
            sys.exit(f"{method}: more than {most} iterations")
