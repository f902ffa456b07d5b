# SPDX-License-Identifier: Apache-2.0
"""The committed table of a validation: docs/validation/NAME.md. Rows carry the commit that was measured; what no longer
counts is reported: a row whose commit is not in the history of the one at hand, or whose criterion reads differently now, is
'stale'."""
import dataclasses
import datetime
import platform
import re
import subprocess


def verdict_of(wanted, met):
    """`met` is True, False, or None. A row that only reports is not met where its measure reports a failure."""
    if met is None or met and re.match(r"reported\b", wanted):
        return "reported"
    return "met" if met else "not met"


def without_paths(text):
    """Absolute paths are those of the machine that measured."""
    return re.sub(r"(?<![\w.:/])/[\w.+-]+(?:/[\w.+-]+)+/?", "...", text)


@dataclasses.dataclass
class Row:
    wanted: str
    got: str
    verdict: str
    commit: str


class History:
    """Commits of a checkout. Git is asked once for each."""

    def __init__(self, root):
        self.root, self._kept = root, {}

    def git(self, *words):
        if words not in self._kept:
            result = subprocess.run(["git", "-C", str(self.root), *words], capture_output=True, text=True)
            self._kept[words] = result.stdout.strip() if result.returncode == 0 else None
        return self._kept[words]

    def head(self):
        return self.git("rev-parse", "--short", "HEAD") or "unknown"

    def has(self, commit):
        return self.git("merge-base", "--is-ancestor", commit, "HEAD") is not None

    def landed(self, commit):
        """The commit of the history that a rebase made of this one (same author's date and subject); None if there is
        none."""
        mark = self.git("show", "-s", "--format=%at %s", commit)
        same = [
            line.split(" ", 1)[0]
            for line in (self.git("log", "--format=%h %at %s") or "").splitlines()
            if mark and line.split(" ", 1)[1] == mark
        ]
        return same[0] if len(same) == 1 else None

    def changed(self, commit, folders):
        """Returns the folders with a change since the commit; '!FOLDER' does not count."""
        without = [f":(exclude){f[1:]}" for f in folders if f.startswith("!")]
        return [
            f
            for f in folders
            if not f.startswith("!") and self.git("diff", "--name-only", commit, "HEAD", "--", f, *without)
        ]

    def date(self, commit):
        return self.git("show", "-s", "--format=%cs", commit)


def commit_of(cell):
    found = re.match(r"[0-9a-f]{7,40}\b", cell)
    return found[0] if found else None


def read(file):
    """Returns {quantity: Row} of the table that is there."""
    rows = {}
    for line in file.read_text().splitlines() if file.exists() else []:
        cells = [c.strip().replace("\\|", "|") for c in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 5 and cells[0] != "quantity" and not cells[0].startswith("---"):
            rows[cells[0]] = Row(*cells[1:])
    return rows


def renewed(bar, row, history):
    """An earlier row as it stands now: with its commit's name in this history, 'stale' where it is no longer valid."""
    if row is None:
        return Row(bar.text, "-", "not measured", "-")
    verdict, commit, cell = re.sub(r"^stale \((.*)\)$", r"\1", row.verdict), commit_of(row.commit), row.commit
    if verdict == "not measured":
        return Row(bar.text, row.got, verdict, cell)
    gone = commit is None or not history.has(commit)
    if gone and commit and (landed := history.landed(commit)):
        cell, gone = cell.replace(commit, landed), False
    if verdict == "met":
        verdict = verdict_of(bar.text, True)
    # A stale row keeps the words that it was measured by.
    return Row(row.wanted, row.got, f"stale ({verdict})" if gone or row.wanted != bar.text else verdict, cell)


def counts(verdicts):
    """'41 of 42 criteria are met; 3 further rows have no criterion': a row that only reports has no criterion."""
    verdicts = list(verdicts)
    reported = sum(v in ("reported", "stale (reported)") for v in verdicts)
    met = verdicts.count("met")
    text = f"{met} of {len(verdicts) - reported} criteria {'is' if met == 1 else 'are'} met"
    for found, one, several in (
        (reported, "further row has no criterion", "further rows have no criterion"),
        (sum(v.startswith("stale") for v in verdicts), "row is stale", "rows are stale"),
        (verdicts.count("not measured"), "criterion has not been measured", "criteria have not been measured"),
    ):
        text += f"; {found} {one if found == 1 else several}" if found else ""
    return text


def age(name, bars, rows, folders, history):
    """Sentence about the age of a table's rows."""
    old = {
        q: commit_of(commit) for q, commit, why in stale(name, bars, rows, folders, history) if why != "not measured"
    }
    measured = [b.quantity for b in bars if b.quantity in rows and rows[b.quantity].verdict != "not measured"]
    dates = sorted(filter(None, (commit and history.date(commit) for commit in old.values())))
    return age_text(datetime.date.today(), len(bars), len(measured), len(old), dates[0] if dates else None)


def age_text(today, n, measured, old, since):
    """Sentence about `n` rows of which `measured` were measured, `old` of them with older source code since that date."""
    count = lambda part: "all" if part == n else "none" if part == 0 else str(part)
    was = lambda part: "was" if part == 1 else "were"
    text = f"As of {today}, {count(measured - old)} of the {n} rows had been measured with the current source code"
    text += f"; {count(old)} {was(old)} measured with older versions, the earliest on {since}" if since else ""
    return text + (f"; {count(n - measured)} {was(n - measured)} not measured." if n > measured else ".")


def write(file, name, table, note="", age=""):
    """`table`: [(quantity, Row)]; `note`: what to know of it, before its rows; `age`: how old they are."""
    text = (
        f"# Validation: {name}\n\n"
        + (f"**{age}**\n\n" if age else "")
        + f"This page was written by `scripts/validate {name} --write` on an {platform.machine()} machine."
        + f" Result: {counts(row.verdict for _, row in table)}. The last column names the commit that was measured.\n\n"
    )
    text += f"{note}\n\n" if note else ""
    text += "| quantity | criterion | measured | | commit |\n|---|---|---|---|---|\n"
    for quantity, row in table:
        cells = (quantity, row.wanted, row.got, row.verdict, row.commit)
        text += "| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |\n"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def stale(name, bars, rows, folders, history):
    """Yields (quantity, commit, why) of the rows that this checkout may no longer give."""
    for bar in bars:
        row = renewed(bar, rows.get(bar.quantity), history)
        commit = commit_of(row.commit)
        if row.verdict == "not measured":
            yield bar.quantity, "-", "not measured"
        elif row.verdict.startswith("stale"):
            reworded = commit and (history.has(commit) or history.landed(commit))
            yield bar.quantity, row.commit, (
                "the criterion reads differently now" if reworded else "its commit is not in this history"
            )
        elif changed := history.changed(commit, bar.sources or folders):
            yield bar.quantity, row.commit, f"changed since: {', '.join(changed)}"
