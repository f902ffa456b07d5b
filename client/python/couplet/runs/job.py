# SPDX-License-Identifier: Apache-2.0
"""One job from its launch line to its end, as if started by hand: output is forwarded as it comes, signals reach the
programs, and no process is left behind."""
from __future__ import annotations

import collections
import ctypes
import datetime
import json
import os
import pathlib
import selectors
import shlex
import shutil
import signal
import subprocess
import sys
import time
import typing
from collections.abc import Mapping

from couplet import places
from couplet.runs import folder as folders
from couplet.runs.case import COUPLER, OURS, Case, expect, load, mapping_of
from couplet.runs.process import CLIENT, Pages, RunFailed, culprit, environment, last_words, owner, raised

if typing.TYPE_CHECKING:
    from couplet.runs.results import Results

PATIENCE = 5.0  # [s] for mpirun to end before everything is killed; it does not listen while it launches many processes
NOBODY_LEFT = 20.0  # [s] that mpirun may stay without any program before it is taken for stuck
LONGEST_PLAN = 100_000  # characters that fit into a variable of the environment
LEAST_TEMPORARY = 256 << 10  # bytes that MPI needs for its own files
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PR_SET_PDEATHSIG = 1


def output_of(case, sets):
    """Output folder from the case and the arguments of --set."""
    name = mapping_of(mapping_of(case.data.get("simulation")).get("output")).get("folder", "out")
    for key, _, value in (words.partition("=") for words in sets):
        given = load(value) if key in ("simulation", "simulation.output") else None
        if isinstance(given, dict):
            given = given.get("output", {}) if key == "simulation" else given
            name = given.get("folder", name)
        elif key == "simulation.output.folder":
            name = value
    return case.file.parent / str(name)


RUN_HELP = "a run: its output folder, or its case"


def run_folder(path):
    """Output folder of a run that is named by this folder or by its case."""
    path = pathlib.Path(path)
    return output_of(Case(path), ()) if path.is_file() or (path / "case.yaml").is_file() else path


def surroundings(parts=()):
    """Environment of the programs: one thread per rank, and this package for participants in Python. couplet-exec need
    not read the case for its `parts`; where the launcher does not pass the variable on, it does."""
    env = environment()
    plan = json.dumps(parts)
    if len(parts) > 1 and len(plan) < LONGEST_PLAN:
        env["COUPLET_PLAN"] = plan
    env["PYTHONPATH"] = os.pathsep.join([str(places.PACKAGE.parent), *filter(None, [env.get("PYTHONPATH")])])
    return env


def ends_with_us():
    """Runs in the child: if this process is killed, the child receives SIGTERM and ends the job."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Job:
    """`ranks` is {participant or coupler: number}; `sets` are KEY=VALUE as on the command line; `flags` are further
    arguments of all programs; `played_by` is {participant: command of the external program}; `alone` runs only this
    participant."""

    def __init__(self, case: Case, ranks=None, sets=(), flags=(), alone=None, played_by=None):
        case = case.changed(sets)
        self.case, self.ranks, self.sets, self.flags = case, dict(ranks or {}), list(sets), list(flags)
        self.alone, self.played_by = alone, dict(played_by or {})
        expect(isinstance(case.participants, dict) and case.participants, f"{case.file}: there are no 'participants'.")
        known = {*case.participants, *([COUPLER] if case.coupled else [])}
        for name in (*self.ranks, *self.played_by, *([alone] if alone else [])):
            expect(
                name in known,
                f"there is no participant '{name}' in {case.file}; the participants are: {', '.join(sorted(known))}",
            )
        job = ({}, alone, self.ranks, self.sets, self.flags, self.played_by)
        self.parts, self.command = case.parts(*job), [str(w) for w in case.command(*job)]
        for name in [alone] if alone else known:
            program = case.build / "bin" / COUPLER if name == COUPLER else case.program(name)
            expect(
                program.name in OURS and program.exists() or case.guest(name, self.played_by),
                (
                    f"{case.file}: the program '{program.name}' of '{name}' is not in {program.parent} nor next to the"
                    f" case. Give its command: --with {name}='COMMAND ...'"
                ),
            )
        self.output = output_of(case, self.sets)
        self.last, self.asked, self.asked_at, self.started, self.limit = (
            collections.deque(maxlen=60),
            0,
            None,
            None,
            float("inf"),
        )

    def line(self):
        """Launch line for a shell."""
        return shlex.join(self.command)

    def record(self):
        """Command that started the job, without absolute paths, so that a copied or moved folder refers to the files in
        its new place."""
        flags, at = self.flags, self.flags.index("--restart") if "--restart" in self.flags else None
        return {
            "case": os.path.relpath(self.case.file, self.output),
            "restart": None if at is None else os.path.relpath(flags[at + 1], self.output),
            "ranks": self.ranks,
            "sets": [s for s in self.sets if not s.startswith("simulation.output.folder=")],
            "flags": flags if at is None else flags[:at] + flags[at + 2 :],
            "alone": self.alone,
            "with": self.played_by,
            "started": datetime.datetime.fromtimestamp(
                time.time() - (time.monotonic() - self.started), datetime.timezone.utc
            ).isoformat(),
        }

    # -- while it runs ------------------------------------------------------------------------------------------------
    def on_signal(self, number, _):
        """Ends the job after the current step, with a checkpoint; on the second signal at once."""
        self.asked += 1
        self.asked_at = self.asked_at or time.time()
        if not self.recorded:
            self.note()  # at once, because the launcher itself would end the job within a step
        if self.asked == 1 and self.recorded and folders.stop(self.output):
            self.say("ends after the current step, with a checkpoint; press Ctrl-C again to end at once")
        elif self.asked <= 2:
            self.process.send_signal(signal.SIGTERM)
            self.limit = time.monotonic() + PATIENCE
        else:
            self.end_all()

    def say(self, text):
        print(f"couplet: {text}", file=sys.stderr, flush=True)

    def end_all(self):
        """Ends all programs and their children."""
        for _ in range(50):
            left = folders.session(self.process.pid)
            for pid in left:
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
            if not left:
                return
            time.sleep(0.02)

    def note(self):
        """Records how the job was started, once it has the folder."""
        if not self.recorded and (pid := folders.driver(self.output)) is not None:
            try:
                self.recorded = int(folders.fields_of(pid)[3]) == self.process.pid
            except (OSError, ValueError):
                return
            if self.recorded:
                folders.write_record(self.output, self.record())

    def pass_on(self, shown):
        """Forwards output until all writers have ended. `shown` has write(data, to), or is None."""
        with selectors.DefaultSelector() as selector:
            for pipe, to in ((self.process.stdout, sys.stdout), (self.process.stderr, sys.stderr)):
                selector.register(pipe, selectors.EVENT_READ, to)
            look, busy = 0.0, time.monotonic()
            while selector.get_map():
                for key, _ in selector.select(0.1):
                    data = os.read(key.fd, 65536)
                    if not data:
                        selector.unregister(key.fileobj)
                    if key.data is sys.stderr:
                        data = self.pages.feed(data, last=not data)
                    if not data:
                        continue
                    self.last.extend(data.decode(errors="replace").splitlines())
                    try:
                        if shown:
                            shown.write(data, key.data)
                    except BrokenPipeError:
                        shown = None
                if not self.recorded and time.monotonic() > look:
                    self.note()
                    look = time.monotonic() + 0.1
                if self.command[0] == "mpirun" and time.monotonic() > busy + NOBODY_LEFT / 4:
                    alone = folders.session(self.process.pid) == [self.process.pid]
                    busy = busy if alone else time.monotonic()
                    if alone and time.monotonic() > busy + NOBODY_LEFT:
                        self.say("all programs have ended but mpirun has not; it is stopped")
                        self.end_all()
                if time.monotonic() > self.limit:
                    self.end_all()
                if self.process.poll() is not None and not selector.select(0):
                    break

    def run(self, shown=None):
        """Runs the job and returns its exit code. `shown` receives its output (terminal.Plain forwards it
        unchanged)."""
        expect(
            folders.driver(self.output) is None,
            (
                f"{self.output} is in use by another job that is still running. End it (couplet stop"
                f" {shlex.quote(str(self.output))}), or give this one another folder: --set"
                " simulation.output.folder=..."
            ),
        )
        temporary = os.environ.get("TMPDIR") or "/tmp"
        expect(
            self.command[0] != "mpirun"
            or not os.path.isdir(temporary)
            or shutil.disk_usage(temporary).free >= LEAST_TEMPORARY,
            (
                f"{temporary} is full, and mpirun needs it for files of its own. Make room there, or set TMPDIR to"
                " another folder"
            ),
        )
        self.recorded, self.started, self.pages = False, time.monotonic(), Pages()
        former, began = folders.read_record(self.output), time.time()
        self.process = subprocess.Popen(
            self.command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=surroundings(self.parts),
            start_new_session=True,
            preexec_fn=ends_with_us,
        )
        before = {s: signal.signal(s, self.on_signal) for s in SIGNALS}
        try:
            self.pass_on(shown)
            code = self.process.wait()
        finally:
            self.end_all()
            for number, handler in before.items():
                signal.signal(number, handler)
        self.seconds = time.monotonic() - self.started
        if not self.recorded and code == 0 and (self.output / folders.LOCK).exists():  # may precede the next poll
            folders.write_record(self.output, self.record())
        started = any(file.stat().st_mtime >= began for file in self.output.glob("*/effective.yaml"))
        if (
            self.recorded
            and former
            and code not in (0, 3, 4)
            and not (started if "--restart" not in self.flags else folders.sets_since(self.output, began))
        ):
            # Rejected, for example for a --set: the record of the results that are there remains, and the next resume
            # does not use this one.
            folders.write_record(self.output, former)
        if self.failed_guest():  # its exit code has a meaning of its own
            return 1
        return code if code >= 0 else 128 - code

    def sizes(self):
        names = (self.alone,) if self.alone else (COUPLER, *self.case.participants)
        return [(name, int(self.ranks.get(name, 1))) for name in names]

    def failed_guest(self):
        """(name, exit code) of the external participant that was the first to end with an error; None otherwise."""
        rank, code = self.pages.exited or (None, 0)
        name = owner(rank, self.sizes())[0] if code else None
        return (name, code) if name not in (None, COUPLER) and self.case.guest(name, self.played_by) else None

    def last_words(self):
        if self.pages.killed and not self.asked:
            return culprit(self.pages.killed, self.sizes())
        said = "\n".join(self.last)
        if (guest := self.failed_guest()) and CLIENT not in said:
            error = raised(said)
            return f"'{guest[0]}' ended with exit code {guest[1]}{f': {error}' if error else ''}"
        if self.process.returncode < 0:
            return (
                f"mpirun was killed by signal {-self.process.returncode} ({signal.strsignal(-self.process.returncode)})"
            )
        return last_words(said)


def run(
    case: Case | str | pathlib.Path,
    ranks: Mapping[str, int] | None = None,
    changes: Mapping[str, typing.Any] | None = None,
    show: bool = False,
    alone: str | None = None,
    build: str | pathlib.Path | None = None,
    **more,
) -> Results:
    """Runs a case to its end and returns its Results. `ranks` is {participant: number}, `changes` {key: value}. Raises
    RunFailed with the last output of the programs. Only from the main thread, which receives the signals."""
    from couplet.runs.results import Results
    from couplet.runs.terminal import Plain

    case = case if isinstance(case, Case) else Case(pathlib.Path(case), build)
    job = Job(case, ranks, case.assignments(changes or {}), alone=alone, **more)
    code = job.run(Plain() if show else None)
    if code != 0:
        raise RunFailed(f"exit code {code}: {job.last_words()}")
    return Results(job.output)
