# SPDX-License-Identifier: Apache-2.0
"""Time and memory of a whole run, measured over its first seconds in a folder of its own, which is removed."""
import dataclasses
import pathlib
import re
import subprocess
import tempfile
import threading
import time

from couplet import places
from couplet.runs.results import Results

STEP = re.compile(r"\] t ?= ?([\d.e+-]+)/([\d.e+-]+) s")
LIMIT = 10.0  # [s] until a run that has made no step is ended
STEPPING = 4.0  # [s] of steps before a run is ended
ENDING = 5.0  # [s] that the last step may take


@dataclasses.dataclass
class Probe:
    ended: bool = False  # the whole run fitted into the probe
    wall: float = float("nan")  # [s] of the whole run; nan if there was no step, or the run failed
    processor: float = float("nan")  # [s] of all programs in the whole run, without waiting for each other
    memory: float = 0.0  # [MB] of all programs together
    said: list = dataclasses.field(default_factory=list)  # what programs said about the size of their steps
    problem: str = ""  # last line of a run that failed


def end(job):
    """Ends the job after its step under way. If that takes long, at once."""

    def at_once():
        for _ in range(2):
            job.terminate()
            time.sleep(0.1)

    job.terminate()
    late = threading.Timer(ENDING, at_once)
    late.daemon = True
    late.start()


def probe(case, words=(), limit=LIMIT, stepping=STEPPING):
    """Probe of the case with these further arguments of `couplet run`."""
    found = Probe()
    with tempfile.TemporaryDirectory(prefix="couplet-probe-", ignore_cleanup_errors=True) as scratch:
        out, start, marks = pathlib.Path(scratch) / "out", time.monotonic(), []
        line = [places.command(), "run", case.file.absolute(), "--bin", case.build / "bin", *words]
        job = subprocess.Popen(
            [*map(str, line), "--set", f"simulation.output.folder={out}"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=scratch,
        )
        timers = [threading.Timer(limit, end, (job,))]
        timers[0].start()
        for text in job.stdout:
            found.problem = text.strip() or found.problem
            if at := STEP.search(text):
                marks.append((time.monotonic(), float(at[1]), float(at[2])))
                if len(marks) == 1:
                    timers[0].cancel()
                    timers.append(threading.Timer(stepping, end, (job,)))
                    timers[1].start()
            elif "sub-steps of" in text and "limit" in text:
                found.said = [text.split("] ", 1)[-1].strip()]
        code, took = job.wait(), time.monotonic() - start
        for timer in timers:
            timer.cancel()
        results = Results(out)
        reports = {name: results.report(name) for name in results.participants()} if out.is_dir() else {}
    if not marks and took > limit:
        found.problem = ""
    found.ended = code in (0, 4)
    found.memory = sum(float(told.get("memory-all", 0)) for told in reports.values())
    worked = sum(told.get("processor-working" if len(reports) > 1 else "processor", 0) for told in reports.values())
    if found.ended:
        found.wall, found.processor, found.problem = took, worked, ""
    elif code == 3 and marks:
        (first, begun, until), (last, reached, _) = marks[0], marks[-1]
        rate = (last - first) / (reached - begun) if reached > begun else (first - start) / reached
        before = first - start if reached > begun else 0.0  # before the second step
        found.wall = before + rate * (until - (begun if reached > begun else 0.0))
        found.processor = worked * found.wall / took
        found.problem = ""
    return found
