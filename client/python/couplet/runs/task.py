# SPDX-License-Identifier: Apache-2.0
"""One run of a study in a folder of its own. It is made once, found again, and never made by two processes at a
time."""
import contextlib
import dataclasses
import fcntl
import hashlib
import json
import os
import pathlib
import shutil
import statistics
import time

from couplet import files
from couplet.places import ROOT
from couplet.runs.case import Case
from couplet.runs.process import RunFailed, commit, launch, machine
from couplet.runs.results import Results

RECORD = "record.json"
SHORT = 0.6  # [s]; shorter runs are measured three times in total
MESHING_COUNTS = 30  # [s]; shorter runs that generated their mesh are repeated without that


@dataclasses.dataclass
class Record:
    """Stored data of a run. `state` is "done" or "failed", with a reason."""

    identity: str
    name: str
    state: str
    reason: str = ""
    settings: dict = dataclasses.field(default_factory=dict)
    ranks: dict = dataclasses.field(default_factory=dict)
    wall: float = 0.0  # [s], the median of the repeats
    cpu: float = 0.0  # [s], the median of the repeats
    spread: float = 0.0  # (largest - smallest) / median of the cpu seconds
    repeats: list = dataclasses.field(default_factory=list)  # [[wall, cpu], ...]
    memory: float = 0.0  # [MB], of all processes together if the programs report it
    steps: int = 0
    iterations: int = 0
    work: float = 0.0  # [s], processor time of all participants without waiting
    phases: dict = dataclasses.field(default_factory=dict)
    version: str = ""
    machine: dict = dataclasses.field(default_factory=dict)
    finished: str = ""


class Task:
    """`changes` is {absolute key: value}; `alone` runs only this participant; `meshed` means that an earlier run
    generated the meshes, whose time does not count."""

    def __init__(self, case: Case, name, folder, changes, alone=None, ranks=None, repeats=1, timeout=3600):
        self.case, self.name, self.folder = (
            case,
            name,
            files.below(pathlib.Path(folder).absolute().parent, pathlib.Path(folder).name),
        )
        self.changes, self.alone, self.ranks = dict(changes), alone, dict(ranks or {})
        self.repeats, self.timeout = repeats, timeout

    def command(self):
        return self.case.command({**self.changes, "simulation.output.folder": str(self.folder)}, self.alone, self.ranks)

    def identity(self):
        what = json.dumps([self.changes, self.alone, self.ranks, self.repeats], sort_keys=True, default=str)
        return hashlib.sha256((what + self.case.digest(self.changes)).encode()).hexdigest()[:16]

    @property
    def results(self):
        return Results(self.folder)

    def record(self):
        """Record of this run, or None if the folder has no record or that of another run."""
        try:
            record = Record(**json.loads((self.folder / RECORD).read_text()))
        except (OSError, ValueError, TypeError):
            return None
        return record if record.identity == self.identity() else None

    @contextlib.contextmanager
    def lock(self, wait=True):
        """Yields true if the lock was taken. It ends with its process."""
        with files.in_place(self.folder.parent, f".{self.folder.name}.lock") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            except BlockingIOError:
                yield False
                return
            yield True

    def make(self):
        """Runs the task and finally writes its record atomically. The caller holds the lock. A failed run has a record,
        too."""
        if self.folder.exists():
            shutil.rmtree(self.folder)
        self.folder.mkdir(parents=True)
        record = Record(
            self.identity(),
            self.name,
            "done",
            settings=self.changes,
            ranks=self.ranks,
            version=commit(ROOT),
            machine=machine(),
        )
        try:
            log, costs = self.folder / "run.log", []
            while len(costs) < self.repeats or len(costs) < 3 and sum(c[1] for c in costs) < SHORT:
                cost = launch(self.command(), log, timeout=self.timeout)
                if "meshing" in log.read_text(errors="replace") and cost.cpu < MESHING_COUNTS:
                    continue  # that run generated the mesh for the next ones
                costs.append([cost.wall, cost.cpu])
            record.repeats = costs
            record.wall, record.cpu = (statistics.median(c[i] for c in costs) for i in (0, 1))
            record.spread = (max(c[1] for c in costs) - min(c[1] for c in costs)) / max(record.cpu, 1e-9)
            for key, value in self.results.costs().items():
                setattr(record, key, value)
            record.memory = record.memory or cost.memory
        except RunFailed as failure:
            record.state, record.reason = "failed", str(failure)
        record.finished = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
        self.write(record)
        return record

    def write(self, record):
        files.write(self.folder, RECORD, json.dumps(dataclasses.asdict(record), indent=1, default=str))
