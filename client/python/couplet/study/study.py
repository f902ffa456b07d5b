# SPDX-License-Identifier: Apache-2.0
"""Study by axes: its runs, table, pictures and report."""
import pathlib
import re

from couplet import files
from couplet.places import ROOT
from couplet.runs import Task, expect, run_all
from couplet.runs.process import machine
from couplet.study import estimates, fits, pictures, table
from couplet.study.axes import Axes
from couplet.study.quantities import quantities_of
from couplet.study.report import Report

KEYS = {
    "participant",
    "alone",
    "axes",
    "quantities",
    "set",
    "leave-out",
    "clock",
    "repeats",
    "timeout",
    "title",
    "text",
    "variants",
    "sweeps",
    "peers",
    "sources",
}


def short(reason):
    """Reason of a failed run for a table, without the arguments at the start of a rejection."""
    refused = re.sub(
        r"^exit code \d+: couplet: The job cannot start: / \[\w+\] (--set .*?: (?=\w+\.))?", "refused: ", reason
    )
    return (refused if refused != reason else f"failed: {reason}")[:260]


class Study:
    def __init__(self, case, out, changes=(), repeats=None):
        section = case.study
        unknown = set(section) - KEYS
        expect(
            not unknown,
            f"{case.file}: study: unknown key '{next(iter(unknown), '')}'; valid keys: {', '.join(sorted(KEYS))}.",
        )
        self.case, self.section, self.out = case, section, pathlib.Path(out)
        participant = section.get("participant", next(iter(case.participants), None))
        expect(
            participant in case.participants,
            f"{case.file}: study.participant: there is no participant '{participant}'.",
        )
        self.participant = participant
        self.alone = participant if section.get("alone") else None
        self.axes = Axes(case, section, participant)
        self.axes.common.update(changes)
        self.quantities = quantities_of(case, section, participant)
        self.clock = section.get("clock", "work" if case.coupled and not self.alone else "cpu")
        expect(
            self.clock in pictures.CLOCKS, f"{case.file}: study.clock: expected one of {', '.join(pictures.CLOCKS)}."
        )
        self.repeats = repeats or int(section.get("repeats", 1))
        self.title = section.get("title", case.file.parent.name)

    def task(self, point):
        return Task(
            self.case,
            point.name,
            files.below(self.out, "runs") / point.name,
            point.changes,
            self.alone,
            point.ranks,
            self.repeats,
            float(self.section.get("timeout", 3600)),
        )

    def run(self, points, jobs=1, again=False, say=print):
        """Rows of these points. Existing runs are not repeated."""
        tasks = [self.task(point) for point in points]
        records = run_all(tasks, jobs, again, say)
        rows = table.rows_of(self.axes, self.quantities, points, tasks, records)
        return rows

    def others(self, peers):
        """Points of other programs by processor time: {quantity: [(name, [(seconds, error)])]}, from the rows `peers`
        and from functions of a file beside the case."""
        found = {
            q.name: [
                (name, [(r.record.cpu, r.errors[q.name]) for r in some if r.errors.get(q.name, 0) > 0])
                for name, some in table.series_of(peers).items()
            ]
            for q in self.quantities
        }
        for quantity, word in (self.section.get("peers") or {}).items():
            from couplet.study.quantities import module

            file, function = (part.strip() for part in word.split(":"))
            try:
                found.setdefault(quantity, []).extend(
                    getattr(module(str(self.case.file.parent / file)), function)(self.out / "peers")
                )
            except ImportError as error:  # an installation has no benchmarks/
                print(f"peers of '{quantity}' are omitted: {error}")
        return {quantity: [(name, points) for name, points in some if points] for quantity, some in found.items()}

    def report(self, rows, peers=(), why=None):
        """Writes runs.csv, the pictures, report.md and report.html, and returns the page. `peers` are rows of other
        programs on the same case, `why` is {program: reason why it did not run}."""
        files.folder(self.out, ".")
        against = table.set_errors(rows, self.quantities, peers)
        table.write(self.out / "runs.csv", rows, self.axes, self.quantities)
        if peers:
            table.write(self.out / "peers.csv", peers, self.axes, self.quantities)
        report = Report(f"Study: {self.title}")
        if self.section.get("text"):
            report.text(str(self.section["text"]).strip())
        where, asked = machine(), self.case.asked.resolve()
        versions = sorted({r.record.version for r in rows})
        report.text(
            f"Of {len(rows)} runs, {sum(not r.good for r in rows)} failed. The runs were made with"
            f" {'commits' if len(versions) > 1 else 'commit'} {' and '.join(versions)} on {where['cores']} cores"
            f" ({where['processor']}). All times are the"
            f" {pictures.CLOCKS[self.clock]}. The table is in `runs.csv`. Repeat the study with `couplet study"
            f" {asked.relative_to(ROOT) if asked.is_relative_to(ROOT) else asked.name}`."
        )
        others = self.others(peers)
        for name, reason in (why or {}).items():
            report.text(f"{name} was not run: {reason}.")
        for quantity in self.quantities:
            self.about(report, rows, quantity, against[quantity.name], others.get(quantity.name, ()))
        if self.axes.refining:
            report.head("Cost")
            report.picture(
                pictures.growth(
                    f"{self.title}: growth of the cost",
                    rows,
                    self.clock,
                    self.axes.refining.name,
                    self.out / "growth.png",
                ),
                "Cost as a function of the size; the exponents are those of the three finest runs.",
            )
        report.picture(
            pictures.phases(f"{self.title}: cost by phase", rows, self.out / "phases.png"),
            "Share of the time by phase.",
        )
        self.all_runs(report, rows)
        return report.write(self.out)

    def about(self, report, rows, quantity, against, others):
        name, safe = quantity.name, "".join(c if c.isalnum() else "-" for c in quantity.name)
        report.head(name)
        report.text(
            "This quantity is itself an error."
            if against == table.ITSELF
            else (
                f"Errors are not available, because {against}."
                if against.startswith("no ")
                else f"Errors are relative to {against}."
            )
        )
        costs = [(getattr(r.record, self.clock), r.errors[name], r) for r in rows if name in r.errors]
        if costs:
            named = {
                **{point: who for who, points in others for point in map(tuple, points)},
                **{c[:2]: c[2].point.name for c in costs},
            }
            front = fits.pareto(list(named))
            report.text(
                "The fastest runs for their error (Pareto front"
                + (", including other programs) are:" if others else ") are:")
            )
            report.table(("run", "seconds", "error"), [(named[p], p[0], p[1]) for p in front])
        report.picture(
            pictures.error_against_time(
                f"{self.title}: {name}", rows, quantity, self.clock, self.out / f"error-{safe}.png", others
            ),
            f"Error of {name} as a function of the time.",
        )
        if others:
            report.text(
                "Other programs gave these results for the same case, in processor seconds of the whole process on one"
                " core:"
            )
            report.table(("program", "seconds", "error"), [(who, *point) for who, points in others for point in points])
        if not self.axes.refining:
            return
        report.picture(
            pictures.order(
                f"{self.title}: order of {name}",
                rows,
                quantity,
                self.axes.refining.name,
                self.out / f"order-{safe}.png",
            ),
            f"Error of {name} as a function of the size.",
        )
        found = estimates.of(rows, quantity)
        if len(found) >= 3:
            report.text(
                "The error estimated from each run and runs that are no finer is within a factor of 2 of the true"
                f" error for {estimates.inside(found)} of {len(found)} runs."
            )
            report.picture(
                pictures.scatter(
                    f"{self.title}: estimated and true error of {name}", found, self.out / f"estimate-{safe}.png"
                ),
                "Estimated error against the true one; between the dashed lines they agree within a factor of 2.",
            )
        if not quantity.is_error:
            lines = []
            for series, limit in table.limits_of(rows, quantity).items():
                finest = table.series_of(rows)[series][-1]
                value = finest.values[name]
                lines.append(
                    (
                        series,
                        value,
                        *(
                            (
                                limit.value,
                                f"{limit.order:.2f}",
                                f"{100 * limit.gci / quantity.size(value, finest):.2g} %",
                            )
                            if limit and quantity.size(value, finest)
                            else ("none", "none", "no limit approached")
                        ),
                    )
                )
            report.text(
                "The Richardson extrapolation of the three finest runs and the grid convergence index (GCI) of the"
                " finest run are:"
            )
            report.table(("series", "finest", "extrapolated", "observed order", "GCI"), lines)

    def all_runs(self, report, rows):
        report.head("All runs")
        names = [q.name for q in self.quantities]
        body = []
        for row in rows:
            if not row.good:
                body.append((*row.point.labels.values(), *("" for _ in names), "", "", "", short(row.reason)))
                continue
            shown = [
                f"{row.values[n]:.5g}"
                + (
                    f" ({100 * row.errors[n]:.2g} %)"
                    if n in row.errors and not q.is_error and not q.given.get("absolute")
                    else ""
                )
                for n, q in zip(names, self.quantities)
            ]
            body.append(
                (
                    *row.point.labels.values(),
                    *shown,
                    getattr(row.record, self.clock),
                    row.record.memory,
                    row.record.iterations,
                    "",
                )
            )
        report.table((*(a.name for a in self.axes.all), *names, "seconds", "MB", "iterations", ""), body)
