#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Period and decay of the free vibration in a run's probes.csv. Usage: vibration.py [FOLDER], by default out/solid."""
import pathlib
import sys

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here.parents[1] / "client/python"))
import couplet  # noqa: E402

FREE_FROM = 10.0  # s; the force is gone since 7 s


def fit(t, y, period=20.0):
    """Returns (period [s], decay of the amplitude a period, amplitude [m] at t = 0): least squares of
    exp(-c t) (A cos w t + B sin w t) over the free vibration; the higher modes are ripples that average out."""
    free = t >= FREE_FROM
    t, y = t[free], y[free]

    def parts(w, c):
        e = np.exp(-c * t)
        basis = np.column_stack([e * np.cos(w * t), e * np.sin(w * t)])
        ab = np.linalg.lstsq(basis, y, rcond=None)[0]
        return basis @ ab, ab

    w, c = 2 * np.pi / period, 0.0
    candidates = 2 * np.pi / np.linspace(0.8 * period, 1.4 * period, 400)
    w = min(candidates, key=lambda z: np.sum((parts(z, 0.0)[0] - y) ** 2))
    for _ in range(30):  # Gauss-Newton in (w, c), the amplitudes eliminated
        base, h = parts(w, c)[0], 1e-6
        jacobian = np.column_stack([(parts(w + h, c)[0] - base) / h, (parts(w, c + h)[0] - base) / h])
        step = np.linalg.lstsq(jacobian, y - base, rcond=None)[0]
        w, c = w + step[0], c + step[1]
        if np.abs(step).max() < 1e-12:
            break
    amplitude = np.hypot(*parts(w, c)[1])
    return 2 * np.pi / w, 1 - np.exp(-c * 2 * np.pi / w), amplitude


def history(folder):
    probes = couplet.read_csv(pathlib.Path(folder) / "probes.csv")
    return probes["time [s]"], probes["tip y [m]"]


def numbers(folder):
    """For scripts/couplet study: period [s], decay of the amplitude a period [1], amplitude [m]."""
    return dict(zip(("period", "decay", "amplitude"), fit(*history(folder))))


def reference():
    rows = [r for r in (here / "reference" / "tip_finite_elements.csv").read_text().splitlines() if r[0] not in "#t"]
    return np.array([[float(v) for v in r.split(",")] for r in rows]).T


if __name__ == "__main__":
    place = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "out" / "solid"
    if not (place / "probes.csv").exists():
        sys.exit(f"There is no result in {place}. Run the case first (see its README).")
    for what, (t, y) in (("run", history(place)), ("finite elements", reference())):
        period, decay, amplitude = fit(t, y)
        print(f"{what}: period {period:.4f} s, amplitude {amplitude:.5f} m, decay {100 * decay:.4f} % a period")
