#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Breaks the code on purpose, a line at a time, and asks whether the tests notice: of each mutant of mutants.py the one broken
file is compiled and linked before the library that has the sound one, and the test made so must fail. Neither the sources nor
the build are touched (but for the targets of the tests, which are brought up to date).
What survives shows a claim that no test holds. Mutants made by rule, and who notices them: campaign.py.
Usage: run.py ROOT BUILD [NAME ...]   (BUILD: a configured build; NAME: only mutants whose name holds one of these)
       run.py ROOT --places            (only whether each line is where the mutant looks for it, and how many the rules give)"""
import pathlib
import re
import sys
import tempfile

import generate
import mutants
from workshop import Workshop, text_of

FEWEST = 200  # of the mutants that the rules draw with the committed seed
LIMIT = 600.0  # seconds of processor time of a test


def places(root):
    """A mutant whose line was rewritten breaks nothing any more."""
    lost = [m for m in mutants.MUTANTS if (root / m.file).read_text().count(m.old) != 1]
    for m in lost:
        print(f"LOST     {m.name}: '{m.old}' is not once in {m.file}")
    print(f"{len(mutants.MUTANTS) - len(lost)} of {len(mutants.MUTANTS)} mutants have their place")
    drawn = generate.sample(root, FEWEST)
    rules = {m.rule for m in drawn}
    steady = drawn[:FEWEST // 2] == generate.sample(root, FEWEST // 2)
    same = [m for m in drawn if m.apply((root / m.file).read_text()) == (root / m.file).read_text()]
    print(f"{len(drawn)} mutants drawn over {len({m.file for m in drawn})} files by {len(rules)} rules; {len(same)} of them change nothing")
    return 1 if lost or same or len({m.name for m in drawn}) < FEWEST or len(rules) < 5 or not steady else 0


def verdict_of(shop, mutant):
    source = (shop.root / mutant.file).read_text()
    if source.count(mutant.old) != 1:
        return "LOST", f"'{mutant.old}' is not once in {mutant.file}"
    text_of("ninja", "-C", shop.build, mutant.target or mutant.test)
    with tempfile.TemporaryDirectory(prefix="couplet-mutant-") as name:
        folder = pathlib.Path(name)
        if shop.run(mutant.test, shop.broken_command(mutant.test, [], folder, [], mutant.only), LIMIT).failed:
            return "RED BEFORE", mutant.test
        made = shop.compiled(mutant.file, source.replace(mutant.old, mutant.new), folder)
        outcome = shop.run(mutant.test, shop.broken_command(mutant.test, [made], folder, [mutant.file], mutant.only), LIMIT)
    claim = re.search(r"^\[  FAILED  \] (\w+\.[\w/]+)", outcome.text, re.M)
    what = claim[1] if claim else "it does not end" if outcome.stopped else mutant.test
    return ("killed", what) if outcome.failed else ("SURVIVED", mutant.test)


def main():
    if sys.argv[2:] == ["--places"]:
        return places(pathlib.Path(sys.argv[1]).resolve())
    shop, names = Workshop(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()), sys.argv[3:]
    chosen = [m for m in mutants.MUTANTS if not names or any(n in m.name for n in names)]
    lost = []
    for mutant in chosen:
        verdict, what = verdict_of(shop, mutant)
        print(f"{verdict:10} {mutant.name} ({what})", flush=True)
        if verdict != "killed":
            lost.append(mutant.name)
    print(f"{len(chosen) - len(lost)} of {len(chosen)} mutants are noticed" + (f"; not: {'; '.join(lost)}" if lost else ""))
    return 0 if chosen and not lost else 1


if __name__ == "__main__":
    sys.exit(main())
