# SPDX-License-Identifier: Apache-2.0
"""Plots that the site draws from committed tables: those of the published studies and, in a checkout, the maps of
stability."""
import pathlib
import re
import sys
import tempfile

from couplet import files
from couplet.places import ROOT
from couplet.runs import Case

ATLAS = pathlib.Path("docs/stability.md")


def of_study(page, text, folder):
    """Draws the tables of a published study below `folder`. Returns the text of its page with the plots at its end."""
    from couplet.study import table
    from couplet.study.study import Study

    with tempfile.TemporaryDirectory(prefix="couplet-plots-") as scratch:
        try:
            study = Study(Case(ROOT / re.search(r"`couplet study ([\w./-]+)`", text)[1]), scratch)
            runs, peers = (
                table.read(file, study.axes, study.quantities) if file.exists() else []
                for file in (ROOT / page.parent / "runs.csv", ROOT / page.parent / "peers.csv")
            )
            for row in peers:
                row.series = row.record.version  # the column holds the name of the program
            drawn = study.report(runs, peers).with_name("report.md").read_text()
        except (KeyError, ValueError, ZeroDivisionError):
            return text + "\nThe study of the case has changed since these runs, which are therefore not plotted.\n"
        for file in pathlib.Path(scratch).glob("*.png"):
            files.copy(file, folder, page.parent / file.name)
    return text + "\n## Plots\n\n" + "\n\n".join(re.findall(r"^!\[.*\]\(.*\)$", drawn, flags=re.M)) + "\n"


def of_atlas(text, folder):
    """Draws the maps of stability below `folder`. Returns the text of their page with a picture above each table."""
    sys.path.insert(0, str(ROOT / "scripts"))
    import atlas
    from atlas import draw

    maps = atlas.maps()
    for m in maps.values():
        with files.part(folder, ATLAS.with_name("stability") / f"{m.name}.png") as made:
            draw.picture(m, atlas.read(ROOT / "docs/stability" / f"{m.name}.csv"), made)
    return re.sub(
        r"^\*.*\[table\]\(stability/([\w-]+)\.csv\)",
        lambda found: f"![{maps[found[1]].title}](stability/{found[1]}.png)\n\n{found[0]}",
        text,
        flags=re.M,
    )


def added(page, text, folder):
    """Text of a page with its plots, if it has any."""
    if page.match("docs/validation/studies/*/report.md"):
        return of_study(page, text, folder)
    return of_atlas(text, folder) if page == ATLAS and (ROOT / "scripts/atlas").is_dir() else text
