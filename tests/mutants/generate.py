#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutants made from the source text. Which ones are drawn depends on the seed and on the statements alone: what is written
elsewhere in a file changes nothing, and a part of a longer list is the beginning of it.
Usage: generate.py ROOT [--sample N] [--seed S] [--files]   (prints the mutants drawn, or the files they are made of as CMake lists them)"""
import argparse
import dataclasses
import functools
import hashlib
import math
import pathlib
import re

import cpp_text
import rules
from fields import FILES, SHARES, folder_of

SEED, SAMPLE = 34, 240
OF_ONE_FUNCTION = 2


@dataclasses.dataclass(frozen=True)
class Generated:
    name: str  # by what is changed into what: the same as long as the statement is
    file: str
    kind: str
    rule: str
    line: int
    begin: int
    end: int
    new: str
    shown: str  # the line as it stands then
    function: int

    def apply(self, source):
        return source[:self.begin] + self.new + source[self.end:]


def _number(*words):
    """Between 0 and 1, by the words alone."""
    return (int(hashlib.sha256("|".join(map(str, words)).encode()).hexdigest()[:13], 16) + 0.5) / 16**13


def of_file(root, file, kind):
    source = (root / file).read_text()
    found, seen = [], {}
    known_as = str(pathlib.PurePath(folder_of(file)) / pathlib.PurePath(file).name)  # names outlive a move to another sub-folder
    for s in cpp_text.statements(source):
        for rule, begin, end, new in rules.broken(s):
            text = re.sub(r"\s+", " ", s.text).strip()
            key = (known_as, text, begin - s.begin, end - begin, new)
            seen[key] = seen.get(key, 0) + 1
            name = hashlib.sha256("|".join(map(str, (*key, seen[key]))).encode()).hexdigest()[:10]
            after = source[:begin] + new + source[end:]
            first = after.rfind("\n", 0, begin) + 1
            last = after.find("\n", begin + len(new))
            shown = re.sub(r"\s+", " ", after[first:last]).strip()
            found.append(Generated(name, file, kind, rule, cpp_text.line_of(source, begin), begin, end, new, shown, s.function))
    return found


@functools.cache
def everything(root):
    return [m for kind, files in FILES.items() for file in files for m in of_file(root, file, kind)]


def weight(m):
    """Constants that stand alone are limits and shares that were chosen more often than parts of a formula."""
    return rules.WEIGHTS[m.rule] * (1 if m.function else 0.3)


def sample(root, count=SAMPLE, seed=SEED):
    """`count` mutants, shared out to the folders, at most one a line and OF_ONE_FUNCTION a function."""
    ordered = sorted(everything(root), key=lambda m: (-math.log(_number(seed, m.name)) / weight(m), m.name))
    chosen, lines, functions, counts = [], set(), {}, {}
    whole = sum(SHARES.values())
    limit = {folder: math.ceil(count * share / whole) for folder, share in SHARES.items()}
    for m in ordered:
        place, line, folder = (m.file, m.function), (m.file, m.line), folder_of(m.file)
        if line in lines or functions.get(place, 0) >= OF_ONE_FUNCTION * (1 if m.function else 4) or counts.get(folder, 0) >= limit[folder]:
            continue
        lines.add(line)
        functions[place] = functions.get(place, 0) + 1
        counts[folder] = counts.get(folder, 0) + 1
        chosen.append(m)
    # So that any beginning of the list holds every folder.
    rank, before = {}, {}
    for m in chosen:
        folder = folder_of(m.file)
        rank[m.name] = (before.get(folder, 0) + 0.5) / limit[folder]
        before[folder] = before.get(folder, 0) + 1
    return sorted(chosen, key=lambda m: (rank[m.name], m.name))[:count]


def main():
    reader = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    reader.add_argument("root", type=pathlib.Path)
    reader.add_argument("--sample", type=int, default=SAMPLE)
    reader.add_argument("--seed", type=int, default=SEED)
    reader.add_argument("--files", action="store_true", help="only the files, as the value of COUPLET_ALONE")
    asked = reader.parse_args()
    drawn = sample(asked.root, asked.sample, asked.seed)
    if asked.files:
        print(";".join(sorted({m.file for m in drawn})))
        return
    for m in drawn:
        print(f"{m.name} {m.file}:{m.line} {m.kind}, {m.rule}: {m.shown}")
    print(f"{len(drawn)} of {len(everything(asked.root))} mutants over {len({m.file for m in drawn})} files")


if __name__ == "__main__":
    main()
