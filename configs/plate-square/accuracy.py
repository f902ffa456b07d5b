# SPDX-License-Identifier: Apache-2.0
"""Errors of a clamped square plate over meshes and numbers of modes; closed forms: 0.00126532 p a^4 / D in the middle
(Timoshenko), lambda of six modes (Leissa)."""
import numpy as np

import couplet

PROGRAM = "plate_modal"
TITLE = "clamped square plate: deflection by modes"
LAMBDA = np.array([35.985, 73.394, 73.394, 108.22, 131.58, 132.20])
RIGIDITY = 200e9 * 0.01 ** 3 / (12 * (1 - 0.3 ** 2))


def settings(n, modes, quadrilaterals=0):
    return {"participants.plate.mesh-parameters": f"{{n: {n}, quadrilaterals: {quadrilaterals}}}",
            "participants.plate.modes.number": modes, "participants.plate.output": "{fields: false}"}


SERIES = {
    "triangles, 66 modes": {str(n): settings(n, 66) for n in (8, 16, 32, 64)},
    "quadrilaterals, 66 modes": {str(n): settings(n, 66, 1) for n in (8, 16, 32, 64)},
    "triangles, 15 modes": {str(n): settings(n, 15) for n in (8, 16, 32, 64)},
    "modes 6, 10, 15, 28, 45, 66 on 32": {f"{m} modes": settings(32, m) for m in (6, 10, 15, 28, 45, 66)},
}


def errors(folder):
    here = folder / "plate"
    static = couplet.read_csv(here / "static.csv")
    frequency = couplet.read_csv(here / "frequencies.csv")["frequency [Hz]"][:6]
    exact = LAMBDA / (2 * np.pi) * np.sqrt(RIGIDITY / 78.5)
    deflection = 0.00126532 * 1000 / RIGIDITY
    return {"error of the deflection by modes": abs(static["largest by modes [m]"][-1] / deflection - 1),
            "error of the deflection": abs(static["largest [m]"][-1] / deflection - 1),
            "worst error of six frequencies": float(np.abs(frequency / exact - 1).max())}
