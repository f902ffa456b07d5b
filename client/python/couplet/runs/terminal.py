# SPDX-License-Identifier: Apache-2.0
"""Output of a run on a terminal: participants, one status line that renews itself, findings above it, and at the end
the results and the verdict. In a file, or with --verbose, the programs' own lines are kept."""
import re
import shutil
import sys
import textwrap
import time

from couplet.runs.case import mapping_of

STATUS = re.compile(r"^\[(\S+) \d+\] (t ?= ?[\d.e+-]+(?:/[\d.e+-]+)? s\s+step.*)")
WORTH = re.compile(r"\] (warning|error):|^couplet|^ +\[\S+\] ")
WIDEST, MOST_FINDINGS = 100, 6


def width():
    return min(shutil.get_terminal_size().columns, WIDEST)


def short(status):
    """Shortens a status line and puts the remaining time before the costs of parts, since the end may not fit."""
    parts = re.split(r"\s{2,}", status.strip())
    first = [p for p in parts if not re.match(r"ETA|\w+ [\d.]+ s$", p)]
    return "  ".join(
        [
            *first,
            *(p for p in parts if p.startswith("ETA")),
            *(p for p in parts if p not in first and not p.startswith("ETA")),
        ]
    ).replace("ETA ", "to go ")


class Plain:
    """Forwards output unchanged."""

    def write(self, data, to):
        to.buffer.write(data)
        to.flush()


class Screen:
    """Lines above a status line that renews itself. Without a terminal each new status is a line of its own."""

    def __init__(self):
        self.live, self.shown = sys.stdout.isatty(), ""

    def status(self, text):
        if text and text != self.shown:
            print(f"\r\033[K{text[:width() - 1]}" if self.live else text, end="" if self.live else "\n", flush=True)
            self.shown = text

    def line(self, text):
        for part in textwrap.wrap(text, width() - 1, subsequent_indent="  ") if self.live else [text]:
            print(f"\r\033[K{part}" if self.live else part, flush=True)
        if self.live and self.shown:
            print(self.shown[: width() - 1], end="", flush=True)

    def clear(self):
        if self.live and self.shown:
            print("\r\033[K", end="", flush=True)
        self.shown = ""


class Digest(Screen):
    """Digest of the programs' lines: the status of the program that drives the steps, and warnings and errors, once per
    kind."""

    def __init__(self, job):
        super().__init__()
        self.job, self.rest, self.told, self.unsaid, self.first = job, {}, set(), [], None

    def with_rate(self, status):
        """Status with the steps per second since the first one."""
        found, now = re.search(r"step +(\d+)\S*", status), time.monotonic()
        step = int(found[1]) if found else 0
        self.first = self.first or (step, now)
        rate = (step - self.first[0]) / max(now - self.first[1], 1e-9)
        return f"{status[:found.end()]}  {rate:.3g} steps/s{status[found.end():]}" if found and rate > 0 else status

    def begin(self):
        simulation = dict(mapping_of(self.job.case.data.get("simulation")))
        simulation |= {
            key: value
            for key, _, value in (
                s.removeprefix("simulation.").partition("=") for s in self.job.sets if s.startswith("simulation.")
            )
        }
        ranks = self.job.ranks
        names = [self.job.alone] if self.job.alone else list(self.job.case.participants)
        name, end = simulation.get('name', self.job.case.file.parent.name), simulation.get('end-time', '?')
        print(f"{name} to t = {end}, results in {self.job.output}"[: width()])
        for name in names[:8]:
            print(
                f"  {name:12} {self.job.case.participants[name].get('program')},"
                f" {ranks.get(name, 1)} {'rank' if ranks.get(name, 1) == 1 else 'ranks'}"
            )
        if len(names) > 8:
            print(f"  and {len(names) - 8} more")
        self.status("starts ...")

    def write(self, data, to):
        *lines, self.rest[to] = (self.rest.get(to, "") + data.decode(errors="replace")).split("\n")
        for line in lines:
            if found := STATUS.match(line):
                if not self.job.case.coupled or self.job.alone or found[1] == "coupler":
                    self.status(self.with_rate(short(found[2])))
            elif WORTH.search(line):
                kind = re.sub(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", "#", line)
                if kind not in self.told and len(self.told) < MOST_FINDINGS:
                    self.line(line.rstrip())
                self.told.add(kind)
            elif to is sys.stderr:
                self.unsaid.append(line)

    def end(self, code):
        """Prints the results, the verdict and the number of further warnings."""
        from couplet.command.report import ending
        from couplet.runs.results import Results

        self.clear()
        if code not in (0, 3, 4):
            # Besides errors of the case, the traceback of a participant in Python.
            told = self.unsaid[-30:] if code == 2 or any(line.startswith("Traceback") for line in self.unsaid) else []
            print(*told, sep="\n", end="\n" if told else "", file=sys.stderr)
            return
        results = Results(self.job.output)
        names = [
            name
            for name in results.participants()
            if name in ([self.job.alone] if self.job.alone else ["coupler", *self.job.case.participants])
        ]
        print(*ending(results, names), sep="\n")
        hidden = len(self.told) - MOST_FINDINGS
        if hidden > 0:
            print(f"{hidden} more warnings in the logs")
