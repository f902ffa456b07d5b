# SPDX-License-Identifier: Apache-2.0
"""Other programs on the case of a study: which ones can run it, their runs, and their rows beside ours."""
import dataclasses
import hashlib
import json
import math
import os
import pathlib
import shutil
import statistics

from couplet import files
from couplet.peers import calculix
from couplet.peers.flow import PROGRAMS, Flow, FlowCase
from couplet.peers.solid import Solid
from couplet.peers.solid_foam import SolidFoam
from couplet.peers.values import Refused
from couplet.runs import Record, RunFailed, Wrong
from couplet.runs.case import with_changes
from couplet.runs.process import environment, launch
from couplet.runs.results import Results
from couplet.study.axes import Point
from couplet.study.table import Row, value_row

LONGEST = 3.0  # a series of a peer ends before a run that would take this many times our longest
SHORT = 0.6  # [s]; shorter runs are measured three times


@dataclasses.dataclass
class Contender:
    name: str  # of the series: "CalculiX C3D20R"
    program: str  # ccx
    make: object  # () -> object with write(folder) -> command, and read(folder, out)


def contenders(data, participant, folder, work, trusted=False):
    """Returns ([Contender], [(name, reason)]) for the sections of a case. Nothing is run."""
    program, found, refused = str(data["participants"][participant].get("program")), [], []
    if program == "fluid_solver":
        try:
            flow = Flow(data, participant, folder, work, trusted)
            found = [Contender(p, p, lambda p=p: FlowCase(flow, p)) for p in PROGRAMS]
        except Refused as error:
            refused.append(("OpenFOAM", str(error)))
    elif program == "solid_solver":
        try:
            solid = Solid(data, participant, folder, work, "CalculiX", trusted)
            found = [
                Contender(f"CalculiX {e}", "ccx", lambda e=e: calculix.Input(solid, e))
                for e, _ in calculix.kinds(solid)
            ]
        except Refused as error:
            refused.append(("CalculiX", str(error)))
        try:
            body = Solid(data, participant, folder, work, "solidDisplacementFoam", trusted)
            found.append(Contender("solidDisplacementFoam", "solidDisplacementFoam", lambda: SolidFoam(body)))
        except Refused as error:
            refused.append(("solidDisplacementFoam", str(error)))
    else:
        refused.append(
            ("CalculiX, OpenFOAM", f"participants.{participant}.program: '{program}' has no counterpart in them")
        )
    return found, refused


class Race:
    """Peers of a study by axes. `why` is {name: reason} for those that could not run."""

    def __init__(self, study, say=print, trusted=False):
        self.study, self.say, self.trusted, self.why = study, say, trusted, {}
        self.folder = files.below(study.out, "peers")

    def settings(self, points):
        """Returns [(point, data)] of points with different input for a peer, by size. Our solver settings do not affect
        it."""
        seen, found = set(), []
        for point in sorted(points, key=lambda p: p.size):
            data = with_changes(self.study.case.data, point.changes)
            own = data["participants"][self.study.participant]
            key = json.dumps(
                [
                    data["simulation"].get("end-time"),
                    {
                        k: v
                        for k, v in own.items()
                        if k
                        in (
                            "mesh",
                            "mesh-parameters",
                            "mesh-scale",
                            "boundaries",
                            "material",
                            "density",
                            "viscosity",
                            "plane",
                            "gravity",
                            "initial-velocity",
                        )
                    },
                ],
                sort_keys=True,
                default=str,
            )
            if key not in seen:
                seen.add(key)
                found.append((point, data))
        return found

    def labels(self, settings):
        """Returns {point: part of a series name}: values of axes that distinguish settings of the same size."""
        size_axis = self.study.axes.refining.name if self.study.axes.refining else None
        found = {}
        for point, _ in settings:
            same = [p for p, _ in settings if p.size == point.size]
            found[point.name] = [
                v for a, v in point.labels.items() if a != size_axis and len({p.labels[a] for p in same}) > 1
            ]
        return found

    def rows(self, ours):
        """Rows of all peers by series. Our longest run in `ours` limits the peers' runs."""
        if self.study.case.coupled and not self.study.alone:
            self.why["CalculiX, OpenFOAM"] = "coupling: coupled cases cannot be exported"
            return []
        settings, found, over = self.settings([r.point for r in ours]), [], {}
        labels, longest = self.labels(settings), max([r.record.cpu for r in ours if r.good], default=60)
        for point, data in settings:
            try:
                able, refused = contenders(
                    data,
                    self.study.participant,
                    self.study.case.file.parent,
                    files.below(self.folder, f"meshes/{point.name}"),
                    self.trusted,
                )
            except Wrong as error:
                able, refused = [], [("CalculiX, OpenFOAM", str(error))]
            self.why.update(dict(refused))
            for contender in able:
                name = ", ".join([contender.name, *labels[point.name]])
                if not shutil.which(contender.program):
                    self.why[contender.name] = f"{contender.program} is not installed"
                    continue
                earlier = over.setdefault(name, [])
                if self.too_long(earlier, point.size, longest):
                    continue
                try:
                    row = self.row(contender, name, point)
                except Wrong as error:  # rejected, or gmsh cannot make its mesh
                    self.why[contender.name] = str(error)
                    continue
                earlier.append((point.size, row.record.cpu if row.good else float("inf")))
                found.append(row)
                self.say(f"{name}, {point.name}: " + (f"{row.record.cpu:.3g} s" if row.good else row.reason))
        return found

    def too_long(self, earlier, size, longest):
        """Extrapolates the growth of the last two runs, at least linearly in the size. A series has two runs unless the
        first took too long."""
        if not earlier:
            return False
        (n, cost), limit = earlier[-1], LONGEST * max(longest, 1.0)
        if len(earlier) == 1:
            return cost > limit
        (coarse, first), grown = earlier[-2], 1.0
        if first > 0:
            grown = (
                max(grown, math.log(cost / first) / math.log(n / coarse))
                if math.isfinite(cost) and n > coarse
                else grown
            )
        return cost * (size / n) ** grown > limit

    def row(self, contender, name, point):
        """Makes a run, once per input, as a row like ours."""
        place = files.folder(
            self.folder, "".join(c if c.isalnum() or c in ".-" else "-" for c in f"{name}-{point.name}")
        )
        folder = files.below(place, "case")
        shutil.rmtree(folder, ignore_errors=True)
        made = contender.make()
        command = made.write(folder)
        record = self.earlier(place, digest(folder))
        if record is None or record.state == "done" and not (place / "results").exists():
            record = self.run(name, made, command, place, folder)
        shutil.rmtree(folder, ignore_errors=True)
        record.version = name  # the column of peers.csv with its name
        row = Row(Point(dict(point.labels), {}, {}, point.size), record, name)
        return value_row(row, self.study.quantities, Results(place / "results"))

    def earlier(self, place, identity):
        try:
            record = Record(**json.loads((place / "record.json").read_text()))
        except (OSError, ValueError, TypeError):
            return None
        return record if record.identity == identity else None

    def run(self, name, made, command, place, folder):
        record = Record(digest(folder), name, "done", version=name)
        shutil.rmtree(files.below(place, "results"), ignore_errors=True)
        try:
            costs = []
            while not costs or len(costs) < 3 and sum(c.cpu for c in costs) < SHORT:
                shutil.rmtree(folder / "postProcessing", ignore_errors=True)
                costs.append(
                    launch(
                        command,
                        place / "run.log",
                        folder,
                        float(self.study.section.get("timeout", 3600)),
                        getattr(made, "environment", environment)(),
                    )
                )
            record.cpu, record.wall = statistics.median(c.cpu for c in costs), statistics.median(c.wall for c in costs)
            record.work, record.memory = record.cpu, max(c.memory for c in costs)
            made.read(folder, place / "results" / self.study.participant)
        except (RunFailed, ValueError, OSError, StopIteration) as error:
            record.state, record.reason = "failed", f"{type(error).__name__}: {error}"
        files.write(place, "record.json", json.dumps(dataclasses.asdict(record), indent=1))
        return record


def digest(folder):
    """Digest of all files for a peer."""
    mark = hashlib.sha256()
    for file in sorted(f for f in pathlib.Path(folder).rglob("*") if f.is_file()):
        mark.update(str(file.relative_to(folder)).encode() + file.read_bytes())
    return mark.hexdigest()[:16]
