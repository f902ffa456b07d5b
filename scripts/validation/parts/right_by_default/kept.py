# SPDX-License-Identifier: Apache-2.0
"""What the issue asks for beside its scenes: guards, findings, meshes and loads that tests hold, the maps of the solid, and no equilibrium called unstable
that is not."""
import json

from couplet.runs import Case
from validation import table

MAPS = ("solid-energy", "solid-stretch", "solid-nu", "solid-buckling", "large-nu", "large-swing", "large-load")
TABLES = ("solid-linear", "solid-energy", "finite-strain")


def maps(job):
    """Of the tables that `couplet atlas` wrote."""
    from couplet.atlas import atlas
    squares = [s for name in MAPS for s in atlas.read(job.root / f"docs/stability/{name}.csv").values()]
    counts = {o: sum(s.outcome == o for s in squares) for o in (atlas.HOLDS, atlas.POOR, atlas.WARNED, atlas.REFUSED, atlas.RED)}
    return f"{len(MAPS)} maps: {', '.join(f'{n} {o}' for o, n in counts.items())}", len(squares) > 500 and counts[atlas.RED] == 0


def stable_cases(job):
    """Every committed case of a static solid at large strain, each file of it."""
    flagged, seen = [], []
    for file in sorted((job.root / "configs").glob("*/*.yaml")):
        try:
            parts = Case(file).participants
        except Exception:  # no case: the settings of a study
            continue
        chosen = {n for n, p in parts.items() if p.get("program") == "solid_solver" and p.get("analysis") == "static" and p.get("kinematics") == "finite-strain"}
        if len(parts) != 1 or not chosen:
            continue
        name = f"{file.parent.name}/{file.stem}"
        run = job.case_run(file, job.scratch / name.replace("/", "-"), (), dict.fromkeys(chosen, 1), 3600)
        seen.append(name)
        findings = json.loads((run.folder / next(iter(chosen)) / "run.json").read_text())["findings"]
        flagged += [name for f in findings if f["id"] == "unstable-equilibrium"]
    return f"{len(flagged)} of {len(seen)}: {', '.join(flagged) or ', '.join(seen)}", len(seen) >= 5 and not flagged


def tables(job):
    """Bars that the tables of b350924 had as met and today's have not, by their names."""
    lost, kept, renamed = [], 0, 0
    for name in TABLES:
        file, before = f"docs/validation/{name}.md", job.scratch / f"{name}.md"
        before.write_text(job.run(["git", "-C", job.root, "show", f"b350924:{file}"]).stdout)
        now = table.read(job.root / file)
        for quantity in (q for q, row in table.read(before).items() if row.verdict == "met"):
            renamed += quantity not in now
            kept += quantity in now and now[quantity].verdict.endswith(("met", "met)")) and "not met" not in now[quantity].verdict
            lost += [quantity] if quantity in now and "not met" in now[quantity].verdict else []
    return f"{kept} still met, {renamed} have gone or another name, lost: {'; '.join(lost) or 'none'}", not lost
