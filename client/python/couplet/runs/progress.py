# SPDX-License-Identifier: Apache-2.0
"""Progress of a run from its regular files."""
import csv
import pathlib
import re

from couplet.runs import folder as folders
from couplet.runs.terminal import STATUS, WORTH, short

ROWS, BYTES = 400, 1 << 18  # limits on what is read from the end of a table


class Log:
    """New content of a log since the last poll."""

    def __init__(self, file):
        self.file, self.at, self.rest = file, 0, ""

    def lines(self):
        try:
            with open(self.file, "rb") as file:
                file.seek(self.at)
                data = file.read()
        except OSError:
            return []
        self.at += len(data)
        *whole, self.rest = (self.rest + data.decode(errors="replace")).split("\n")
        return whole


class Logs:
    """Logs of all participants of a job."""

    def __init__(self, folder):
        self.folder, self.logs = pathlib.Path(folder), {}

    def look(self):
        """Returns (status or "", [warnings and errors]) since the last poll. The status is that of the program that
        drives the steps."""
        status, worth = "", []
        for name in sorted(p.name for p in self.folder.iterdir() if p.is_dir() and (p / f"{p.name}.log").exists()):
            for line in self.logs.setdefault(name, Log(self.folder / name / f"{name}.log")).lines():
                text = re.sub(r"^\[[\d :.-]+\]\s*", "", line).strip()
                if WORTH.search(text):
                    worth.append(text)
                elif (found := STATUS.match(text)) and (name == "coupler" or not (self.folder / "coupler").exists()):
                    status = short(found[2])
        return status, worth


def tail(file, rows=ROWS):
    """Returns {head: last numbers} of a growing table. Other values are skipped."""
    try:
        with open(file, "rb") as stream:
            head = stream.readline().decode(errors="replace")
            start = stream.tell()
            size = stream.seek(0, 2)
            stream.seek(max(start, size - BYTES))
            text = stream.read().decode(errors="replace")
            cut = size - BYTES > start
    except OSError:
        return {}
    lines = text.split("\n")[1 if cut else 0 : -1][-rows:]  # the last one may be incomplete
    names, columns = next(csv.reader([head]), []), {}
    table = [r for r in csv.reader(lines) if len(r) == len(names)]
    for i, name in enumerate(names):
        try:
            values = [float(r[i]) for r in table]
        except ValueError:
            continue
        columns[name.strip()] = [v if abs(v) < 1e300 else None for v in values]  # nan and inf are not valid JSON
    return columns


def curves(folder):
    """Returns [{title, x label, log, lines: {name: [[x, y], ...]}}]: residuals, step size, probes."""
    folder, found = pathlib.Path(folder), []
    residuals = tail(folder / "coupler" / "residuals.csv")
    if residuals:
        lines = {name: list(enumerate(values)) for name, values in residuals.items() if "residual" in name}
        found.append({"title": "residuals of the coupling", "x": "iterations", "log": True, "lines": lines})
    for place in sorted(p for p in folder.iterdir() if p.is_dir()) if folder.is_dir() else ():
        steps, probes = tail(place / "steps.csv"), tail(place / "probes.csv")
        if "dt [s]" in steps:
            found.append(
                {
                    "title": f"step size of {place.name}",
                    "x": "time [s]",
                    "log": False,
                    "lines": {"dt [s]": list(zip(steps["time [s]"], steps["dt [s]"]))},
                }
            )
        if len(probes) > 1:
            time = next(iter(probes))
            found.append(
                {
                    "title": f"probes of {place.name}",
                    "x": time,
                    "log": False,
                    "lines": {n: list(zip(probes[time], v)) for n, v in list(probes.items())[1:9]},
                }
            )
    return found


def by_tables(folder):
    """Status of a quiet run."""
    for file in [folder / "coupler" / "participants.csv", *sorted(folder.glob("*/steps.csv"))]:
        if times := next(iter(tail(file, 1).values()), []):
            return f"t={times[-1]:.6g} s"
    return ""


class Progress:
    """Content of the page about a run; each poll adds new data."""

    def __init__(self, folder):
        self.folder, self.logs, self.status, self.worth = pathlib.Path(folder), Logs(folder), "", []

    def state(self):
        status, worth = self.logs.look()
        self.status = status or (self.status if "step" in self.status else by_tables(self.folder))
        self.worth += [w for w in worth if w not in self.worth]
        return {
            "folder": str(self.folder),
            "running": folders.driver(self.folder) is not None,
            "status": self.status,
            "warnings": self.worth[-20:],
            "curves": curves(self.folder),
        }
