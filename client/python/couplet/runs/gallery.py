# SPDX-License-Identifier: Apache-2.0
"""Cases of the gallery, and copies of them for the user."""
import csv
import dataclasses
import pathlib
import re
import subprocess

import yaml

from couplet import files
from couplet.places import ROOT
from couplet.runs.case import Case, expect
from couplet.runs.probe import probe


CELLS = "cells.csv"


@dataclasses.dataclass
class Entry:
    name: str
    title: str  # first words of its README
    about: str  # first text of the README
    programs: list
    picture: str  # file beside README.md or below docs/, as named in the README; may be empty
    cells: str = ""  # of the largest mesh (configs/cells.csv)
    seconds: str = ""  # approximate seconds of one core for the whole run (same file)

    @property
    def folder(self):
        return ROOT / "configs" / self.name


def entry(folder):
    readme = (folder / "README.md").read_text() if (folder / "README.md").exists() else ""
    title = re.search(r"^# (.*)", readme, flags=re.M)
    about = re.search(r"^(?![#!|]|```)\S.*(?:\n(?![#!|\n]|```).+)*", readme, flags=re.M)
    picture = re.search(r"!\[[^]]*\]\(([^)\s]+)", readme)
    case = Case(folder)
    programs = [str((p or {}).get("program", "?")) for p in case.participants.values()]
    return Entry(
        folder.name,
        title[1] if title else folder.name,
        " ".join(about[0].split()) if about else "",
        programs,
        picture[1] if picture else "",
    )


def entries():
    found = [entry(file.parent) for file in sorted((ROOT / "configs").glob("*/case.yaml"))]
    table = ROOT / "configs" / CELLS
    rows = {row[0]: row[1:] for row in csv.reader(table.read_text().splitlines())} if table.exists() else {}
    for e in found:
        e.cells, e.seconds = (*rows.get(e.name, ()), "", "")[:2]
    return found


def cells_of_all(build, limit=0):
    """Text of cells.csv: the largest cell count of each case, and the processor seconds of a run (kept if
    `limit` is 0)."""
    text, before = "case,cells,seconds\n", {e.name: e.seconds for e in entries()}
    for file in sorted((ROOT / "configs").glob("*/case.yaml")):
        case, most = Case(file, build), 0
        for name in case.participants:
            if case.program(name).exists():
                said = subprocess.run(
                    [case.program(name), case.file, "--explain", "--participant", name], capture_output=True, text=True
                ).stdout
                most = max([most, *map(int, re.findall(r"^mesh: +(\d+) cells", said, flags=re.M))])
        seconds = before[case.file.parent.name]
        if limit:
            processor = probe(case, (), limit, limit).processor
            seconds = f"{float(f'{processor:.1g}'):g}" if processor > 0 else ""
        text += f"{case.file.parent.name},{most or ''},{seconds}\n"
    return text


def find(name):
    """Case file of the gallery with this name, CASE or CASE/file.yaml."""
    import difflib

    there = sorted(file.parent.name for file in (ROOT / "configs").glob("*/case.yaml"))
    file = ROOT / "configs" / name
    file = file / "case.yaml" if file.is_dir() else file
    near = dict.fromkeys([*(n for n in there if name and name in n), *difflib.get_close_matches(name, there, 3)])
    expect(
        file.is_file() and ".." not in pathlib.PurePath(name).parts,
        (
            f"there is no case '{name}' in the gallery;"
            f" {'near: ' + ', '.join(near) if near else 'couplet gallery lists them'}"
        ),
    )
    return file


# -- a copy
# --------------------------------------------------------------------------------------------------------------
def scalars(node, path=()):
    """Returns {path: node} of the scalars of a composed YAML document."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield from scalars(value, (*path, key.value))
    elif isinstance(node, yaml.SequenceNode):
        for i, value in enumerate(node.value):
            yield from scalars(value, (*path, str(i)))
    else:
        yield ".".join(path), node


def with_values(text, values):
    """Replaces the values at existing keys. Comments and order are kept."""
    places = dict(scalars(yaml.compose(text)))
    for key in values:
        expect(key in places, f"--set {key}: the case has no such value to replace; set it in the new file")
    spots = {
        (places[key].start_mark.index, places[key].end_mark.index): value for key, value in values.items()
    }  # an anchor has several keys
    for (start, end), value in sorted(spots.items(), reverse=True):
        text = text[:start] + value + text[end:]
    return text


def included(file):
    """Files included by a .geo."""
    for name in (
        re.findall(r'^\s*(?:Include|Merge)\s*"([^"]+)"', file.read_text(errors="replace"), flags=re.M)
        if file.suffix == ".geo"
        else ()
    ):
        if (file.parent / name).is_file():
            yield file.parent / name
            yield from included(file.parent / name)


def copy(source, target, values):
    """Copies a case with all named files to a folder, with other values. Returns the new case file."""
    target = files.below(target.parent, target.name)
    expect(
        not target.exists() or target.is_dir() and not any(target.iterdir()),
        f"folder '{target}' exists and is not empty; choose a new name",
    )
    case, text = Case(source), source.read_text()
    moved = {
        key: node.value
        for key, node in scalars(yaml.compose(text))
        if isinstance(node.value, str)
        and len(node.value) < 200
        and "\n" not in node.value
        and (source.parent / node.value).is_file()
    }
    named = {(source.parent / name).resolve() for name in moved.values()} | {
        f.resolve() for f in case.named([case.data])
    }
    named |= {extra.resolve() for file in list(named) for extra in included(file)}
    guests = {
        g
        for p in case.participants
        if (words := case.guest(p))
        for g in map(pathlib.Path, map(str, words))
        if g.parent == source.parent
    }
    named |= {extra for extra in (*source.parent.glob("*.py"), source.parent / "README.md") if extra.is_file()}
    text = with_values(text, {**{key: pathlib.Path(name).name for key, name in moved.items() if "/" in name}, **values})
    files.folder(target, ".")
    for file in (*named, *guests):  # Python and guests may be links: copied under their own names
        files.copy(file, target)
    return files.write(target, "case.yaml", text)
