# SPDX-License-Identifier: Apache-2.0
"""Errors of the clamped square plate against closed forms: 0.00126532 p a^4 / D in the middle (Timoshenko), lambda of six modes (Leissa)."""
import numpy as np

import couplet

LAMBDA = np.array([35.985, 73.394, 73.394, 108.22, 131.58, 132.20])
RIGIDITY = 200e9 * 0.01 ** 3 / (12 * (1 - 0.3 ** 2))


def errors(folder):
    static = couplet.read_csv(folder / "static.csv")
    frequency = couplet.read_csv(folder / "frequencies.csv")["frequency [Hz]"][:6]
    exact, deflection = LAMBDA / (2 * np.pi) * np.sqrt(RIGIDITY / 78.5), 0.00126532 * 1000 / RIGIDITY
    return {"by modes": abs(static["largest by modes [m]"][-1] / deflection - 1), "deflection": abs(static["largest [m]"][-1] / deflection - 1),
            "frequencies": np.abs(frequency / exact - 1).max()}
