# SPDX-License-Identifier: Apache-2.0
"""The committed studies of the coupling: schemes, accelerations, tolerances and steps of FSI1, the tube and a light flap."""
import csv


def committed(job, folder):
    """How many runs, and the cheapest ones that meet three errors."""
    place = job.root / "docs/validation/studies" / folder
    with open(place / "runs.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    good = [r for r in rows if not r["reason"]]
    error = next(k for k in rows[0] if k.startswith("error of"))
    best = min(float(r[error]) for r in good)
    texts = []
    for factor in (10, 3, 1.2):
        cheapest = min((r for r in good if float(r[error]) <= factor * best), key=lambda r: float(r["work [s]"]))
        texts.append(f"{float(cheapest[error]):.1e} by {cheapest['scheme']}, {cheapest['acceleration']}, {cheapest['tolerance']}, {cheapest['steps']} steps in {float(cheapest['work [s]']):.2g} s")
    pictures = list(place.glob("error-*.png"))
    return f"{len(rows)} runs, {len(rows) - len(good)} failed with their reason; cheapest: {'; '.join(texts)}", len(good) >= 12 and bool(pictures) and (place / "report.md").exists()
