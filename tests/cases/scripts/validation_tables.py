#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tables of bars: what only reports is not counted, a row of a commit that is not in the history is stale, a rebased one is
found again, and --stale names the folders that changed."""
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts"))
from validation import table  # noqa: E402
from validation.job import Bar  # noqa: E402


def git(folder, *words):
    return subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", "-C", folder, *words], check=True,
                          capture_output=True, text=True).stdout.strip()


def commit(folder, file, text):
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text(text)
    git(folder, "add", "-A")
    git(folder, "commit", "-qm", f"{file} {text}")
    return git(folder, "rev-parse", "--short", "HEAD")


for wanted, met, verdict in (("<= 1", True, "met"), ("<= 1", False, "not met"), ("reported", True, "reported"),
                             ("<= 1", None, "reported"), ("reported", False, "not met")):
    assert table.verdict_of(wanted, met) == verdict, (wanted, met)
assert table.counts(["met", "not met", "reported", "stale (met)", "stale (reported)"]) == "1 of 3 criteria is met; 2 further rows have no criterion; 2 rows are stale"

assert table.without_paths("saved in /home/me/a-b/run.1, 3 m/s, see https://a.org/b/c and docs/x.md") == "saved in ..., 3 m/s, see https://a.org/b/c and docs/x.md"

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    git(folder, "init", "-qb", "main")
    first = commit(folder, "solid/a", "1")
    git(folder, "checkout", "-qb", "side")
    measured = commit(folder, "solid/a", "2")
    lost = commit(folder, "fluid/b", "1")
    git(folder, "checkout", "-q", "main")
    commit(folder, "docs/c", "1")
    git(folder, "-c", "core.editor=true", "cherry-pick", measured)
    landed = git(folder, "rev-parse", "--short", "HEAD")
    commit(folder, "fluid/b", "2")
    history = table.History(folder)
    bars = [Bar("old", "<= 1", None), Bar("rebased", "<= 1", None), Bar("lost", "<= 1", None), Bar("reworded", "<= 2", None),
            Bar("new", "<= 1", None), Bar("other mesh", "<= 1", None, but="a finer mesh"), Bar("shown", "reported", None)]
    rows = {"old": table.Row("<= 1", "0 | 1", "met", first), "rebased": table.Row("<= 1", "0", "met", f"{measured}, script of x"),
            "lost": table.Row("<= 1", "0", "met", lost), "reworded": table.Row("<= 1", "0", "met", landed),
            "other mesh": table.Row("<= 1 (differs from the original request: a finer mesh)", "0", "met", landed),
            "shown": table.Row("reported", "5", "met", landed)}
    file = folder / "table.md"
    table.write(file, "x", list(rows.items()))
    assert table.read(file) == rows
    now = {b.quantity: table.renewed(b, rows.get(b.quantity), history) for b in bars}
    assert [r.verdict for r in now.values()] == ["met", "met", "stale (met)", "stale (met)", "not measured", "met", "reported"], now
    assert now["rebased"].commit == f"{landed}, script of x", now["rebased"]
    # Again and again gives the same, and a stale row stays one.
    assert all(table.renewed(b, now[b.quantity], history).verdict == now[b.quantity].verdict for b in bars)
    why = {q: w for q, _, w in table.stale("x", bars, rows, ("solid", "fluid"), history)}
    assert why == {"old": "changed since: solid, fluid", "rebased": "changed since: fluid", "lost": "its commit is not in this history",
                   "reworded": "the criterion reads differently now", "new": "not measured", "other mesh": "changed since: fluid",
                   "shown": "changed since: fluid"}, why
    assert history.changed(first, ("fluid", "!fluid/b")) == [] and history.changed(first, ("fluid",)) == ["fluid"]
    assert table.age("x", bars, rows, ("solid", "fluid"), history).endswith(f", none of the 7 rows had been measured with the current source code; 6 were measured with older versions, the earliest on {history.date(first)}; 1 was not measured.")
    assert "3 of the 7 rows had been measured with the current source code; 3 were measured with older versions" in table.age("x", bars, rows, ("docs",), history), table.age("x", bars, rows, ("docs",), history)
result = subprocess.run([ROOT / "scripts/validate", "--stale", "nothing"], capture_output=True, text=True)
assert result.returncode == 2 and "there is: " in result.stderr, result.stderr
