# SPDX-License-Identifier: Apache-2.0
"""Shows how a run goes on, from the files that it writes anyway: time, step, iterations, residual, time to go, and findings as they
come. Ends with the run; Ctrl-C ends the watching alone."""
import pathlib
import re
import time

from couplet.runs import folder as folders
from couplet.runs.case import expect
from couplet.runs.results import Results
from couplet.runs.terminal import STATUS, WORTH, Screen, short



def declare(parser):
    parser.add_argument("folder", type=pathlib.Path, metavar="FOLDER", help="the output folder of the run")
    parser.add_argument("--every", type=float, default=0.5, metavar="SECONDS", help="looks so often (0.5)")
    parser.add_argument("--once", action="store_true", help="tells how it stands and ends")


class Log:
    """What a log has got since the last look."""

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


def said(line):
    """A line of a log without its date."""
    return re.sub(r"^\[[\d :.-]+\]\s*", "", line).strip()


def look(folder, logs, screen):
    """One look at all logs; the driver's is the one with the steps."""
    status = ""
    for name in (p.name for p in folder.iterdir() if p.is_dir() and (p / f"{p.name}.log").exists()):
        for line in logs.setdefault(name, Log(folder / name / f"{name}.log")).lines():
            text = said(line)
            if WORTH.search(text):
                screen.line(text)
            elif (found := STATUS.match(text)) and (name == "coupler" or not (folder / "coupler").exists()):
                status = short(found[2])
    screen.status(status)


def ending(folder):
    """How the run ended, by its reports."""
    results = Results(folder)
    reports = {name: results.report(name) for name in results.participants()}
    driver = reports.get("coupler") or next(iter(reports.values()), {})
    if not driver:
        return "there is no run at work here, and none has come to its end"
    findings = results.findings()
    text = f"{driver.get('state', 'ended')} at t = {driver.get('time', 0):g} s after {driver.get('steps', 0)} steps, {driver.get('wall', 0):.1f} s"
    text += f": {driver['reason']}" if driver.get("reason") else ""
    return text + (f"; findings: {', '.join(sorted({f['id'] for f in findings}))}" if findings else "")


def run(arguments):
    folder = arguments.folder
    expect(folder.is_dir(), f"{folder}: there is no such folder")
    logs, screen = {}, Screen()
    try:
        while True:
            at_work = folders.driver(folder) is not None
            look(folder, logs, screen)
            if arguments.once or not at_work:
                break
            time.sleep(arguments.every)
    except KeyboardInterrupt:
        pass
    if screen.live and screen.shown:
        print()
    if folders.driver(folder) is None:
        print(ending(folder))
    return 0
