#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutants drawn by chance from all sources of the programs and of common; no test is known here. Every statement that a rule can
break has the same chance, and so has each way to break it. What is drawn depends on the seed and on the statements alone, and a part
of a longer list is the beginning of it.
Usage: generate.py ROOT [--sample N] [--seed S]   (prints the mutants drawn)"""
import argparse
import dataclasses
import functools
import hashlib
import pathlib
import re

import cpp_text
import rules

SEED, SAMPLE = "867187a9385e010e2316788e6881e7cd088b1055", 120
FOLDERS = ("common", "coupler", "fluid_solver", "mesh_mover", "plate_modal", "solid_solver", "thermocline")


@dataclasses.dataclass(frozen=True)
class Generated:
    name: str  # by what is changed into what: the same as long as the statement is
    file: str
    rule: str
    line: int
    begin: int
    end: int
    new: str
    shown: str  # the line as it stands then
    statement: str  # what stands there now, with its file
    function: int  # 0 for a constant outside of all
    choice: tuple  # edits (begin, end, text) that let ON choose between both

    def apply(self, source):
        return source[:self.begin] + self.new + source[self.end:]


def _number(*words):
    return hashlib.sha256("|".join(map(str, words)).encode()).hexdigest()


def of_file(root, file):
    source = (root / file).read_text()
    found, seen = [], {}
    parts = pathlib.PurePath(file).parts
    known_as = "/".join((*parts[:2 if parts[0] == "common" else 1], parts[-1]))  # names outlive a move to another sub-folder
    for s in cpp_text.statements(source):
        text = re.sub(r"\s+", " ", s.text).strip()
        seen[text] = seen.get(text, 0) + 1
        for rule, begin, end, new, choice in rules.broken(s):
            key = (known_as, text, begin - s.begin, end - begin, new)
            seen[key] = seen.get(key, 0) + 1
            name = _number(*key, seen[key])[:10]
            after = source[:begin] + new + source[end:]
            first = after.rfind("\n", 0, begin) + 1
            last = after.find("\n", begin + len(new))
            shown = re.sub(r"\s+", " ", after[first:last]).strip()
            found.append(Generated(name, file, rule, cpp_text.line_of(source, begin), begin, end, new, shown,
                                   f"{known_as}|{text}|{seen[text]}", s.function, choice))
    return found


@functools.cache
def everything(root):
    files = sorted(f for folder in FOLDERS for kind in ("*.cpp", "*.hpp") for f in (root / folder).rglob(kind))
    return [m for f in files for m in of_file(root, f.relative_to(root).as_posix())]


def sample(root, count=SAMPLE, seed=SEED):
    """`count` statements, each with one of the ways to break it."""
    ways = {}
    for m in everything(root):
        ways.setdefault(m.statement, []).append(m)
    drawn = sorted(ways, key=lambda statement: _number(seed, statement))[:count]
    return [min(ways[statement], key=lambda m: _number(seed, m.name)) for statement in drawn]


def main():
    reader = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    reader.add_argument("root", type=pathlib.Path)
    reader.add_argument("--sample", type=int, default=SAMPLE)
    reader.add_argument("--seed", default=SEED)
    asked = reader.parse_args()
    drawn = sample(asked.root, asked.sample, asked.seed)
    for m in drawn:
        print(f"{m.name} {m.file}:{m.line} {m.rule}: {m.shown}")
    print(f"{len(drawn)} of {len({m.statement for m in everything(asked.root)})} statements over {len({m.file for m in drawn})} files")


if __name__ == "__main__":
    main()
