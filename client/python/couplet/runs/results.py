# SPDX-License-Identifier: Apache-2.0
"""Results in the output folder of a run: series, probes, monitors, step reports, and the summary of each
participant."""
from __future__ import annotations

import csv
import json
import pathlib
import typing

from couplet.runs.case import expect

if typing.TYPE_CHECKING:  # starting a run needs neither numpy nor h5py
    import numpy as np

    from couplet.series import FieldSeries, Surface


def read_csv(file: str | pathlib.Path, heads: list[str] | None = None) -> dict[str, np.ndarray]:
    """Columns of a CSV by their heads (given, or from its first line). Texts are kept, and a truncated row (of a
    running job) is skipped."""
    import numpy as np  # imported late, since starting a run does not need it

    with open(file, newline="") as lines:
        rows = [
            *([heads] if heads else []),
            *csv.reader(line for line in lines if line.strip() and not line.startswith("#")),
        ]
    head, body = [h.strip() for h in rows[0]], [r for r in rows[1:] if len(r) == len(rows[0])]
    columns = {}
    for i, name in enumerate(head):
        try:
            columns[name] = np.array([float(r[i]) for r in body])
        except ValueError:
            columns[name] = np.array([r[i] for r in body])
    return columns


class Results:
    """Output folder of a run: <folder>/<participant>/..."""

    def __init__(self, folder: str | pathlib.Path):
        self.folder = pathlib.Path(folder)

    def participants(self) -> list[str]:
        """Names of the participants that have written something, and the coupler."""
        return sorted(
            f.name
            for f in self.folder.iterdir()
            if f.is_dir() and f.name not in ("checkpoints", "meshes") and any(f.glob("*.log"))
        )

    def table(self, participant: str, file: str) -> dict[str, np.ndarray]:
        """Columns of <participant>/<file> by their heads. Raises LookupError if there is no such file."""
        path = self.folder / participant / file
        if not path.exists():
            raise LookupError(f"there is no {participant}/{file}")
        return read_csv(path)

    def column(self, participant: str, file: str, name: str) -> np.ndarray:
        """One column of a table. Raises LookupError with the columns that there are."""
        table = self.table(participant, file)
        if name not in table:
            raise LookupError(f"{participant}/{file} has no column '{name}'; it has: {', '.join(table)}")
        return table[name]

    def last(self, participant: str, file: str) -> dict[str, float]:
        """Returns {head: last value} of a table."""
        return {name: values[-1] for name, values in self.table(participant, file).items()}

    def passes(self) -> typing.NoReturn:
        """Former name of `iterations`."""
        raise AttributeError("Results.passes is now called Results.iterations")

    def iterations(self) -> np.ndarray:
        """Coupling iterations of each accepted step."""
        import numpy as np

        return np.unique(self.table("coupler", "residuals.csv")["step"], return_counts=True)[1]

    def fields(self, participant: str) -> FieldSeries:
        """Field series of a participant: times, cells, and fields by name as arrays."""
        from couplet.series import find_series

        return find_series(self.folder / participant)

    def surfaces(self, participant: str) -> list[str]:
        """Patches with written fields (`output.surfaces`)."""
        from couplet.series import surface_names

        return surface_names(self.folder / participant)

    def surface(self, participant: str, patch: str) -> Surface:
        """Fields on a patch over time with one row per face or point; areas, integrals, and the chain of edges in
        2-D."""
        from couplet.series import find_surface

        return find_surface(self.folder / participant, patch)

    def probes(self, participant: str) -> dict[str, np.ndarray]:
        """Columns of probes.csv by their heads, such as 'tip displacement x [m]'."""
        return self.table(participant, "probes.csv")

    def findings(self) -> list[dict[str, typing.Any]]:
        """Findings of the run: [{participant, id, severity, ...}] as in run.json."""
        return [
            {"participant": name, **found}
            for name in self.participants()
            for found in self.report(name).get("findings", ())
        ]

    def budget(self) -> dict[str, dict[str, float]]:
        """Error contributions {participant: {mesh, step, linear, coupling, model: share of the solution}} as far as the
        run could estimate them. `model` is due to neglected effects."""
        told = {
            name: {k: v for k, v in self.report(name).get("errors", {}).items() if isinstance(v, (int, float))}
            for name in self.participants()
        }
        return {name: parts for name, parts in told.items() if parts}

    def report(self, participant: str) -> dict[str, typing.Any]:
        """Content of run.json, which every program writes at its end; {} before. Raises Wrong if it is damaged."""
        path = self.folder / participant / "run.json"
        if not path.exists():
            return {}
        try:
            told = json.loads(path.read_text())
        except ValueError:
            told = None
        expect(isinstance(told, dict), f"{path}: this is not the report of a run, or it is damaged")
        return told

    def steps(self, participant: str) -> dict[str, np.ndarray]:
        """Columns of steps.csv: time, dt, iterations, error, energy, seconds of each accepted step."""
        return self.table(participant, "steps.csv")

    def costs(self) -> dict[str, typing.Any]:
        """Costs over all participants: steps, iterations, memory [MB], processor seconds of work (without waiting),
        phases {name: seconds}."""
        found = {"steps": 0, "iterations": 0, "memory": 0.0, "work": 0.0, "phases": {}}
        for name in self.participants():
            report = self.report(name)
            found["steps"] = max(found["steps"], int(report.get("steps", 0)))
            found["iterations"] += int(report.get("iterations", 0))
            found["memory"] += float(report.get("memory-all", 0))
            found["work"] += float(report.get("processor-working", 0))
            for phase, seconds in report.get("phases", {}).items():
                if phase.startswith("waiting") or ":" in phase:  # a colon marks a part of another phase
                    continue
                label = phase if len(self.participants()) == 1 else f"{name}: {phase}"
                found["phases"][label] = found["phases"].get(label, 0) + seconds
        return found
