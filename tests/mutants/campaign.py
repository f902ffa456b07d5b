#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which mutants drawn by chance survive the quick suite. All of them stand in one build of a copy of the tree, and a variable of the
environment says which one acts. Each test runs once as it is, which shows the mutants that it reaches, and then with each of those
that still lives, cheap tests first; a mutant that fails a test is noticed if the test passes again without it. What is known is kept
in RESULTS (JSON lines), and a later call continues it.
Usage: campaign.py ROOT COPY RESULTS [--sample N] [--limit SECONDS] [--tests REGEX] [--again REGEX] [--only write|build|judge|show]"""
import argparse
import collections
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import generate
from workshop import Workshop

LIMIT = 120.0  # seconds of processor time for the tests of a mutant
MOST_OF_A_TEST = 40.0
DRAWN = 400  # of which those that compile count, in their order


class Records:
    def __init__(self, file):
        self.file = file
        self.refused, self.killed, self.asked, self.tests = set(), {}, collections.defaultdict(dict), {}
        for line in file.read_text().splitlines() if file.exists() else []:
            self._take(json.loads(line))

    def _take(self, e):
        if "refused" in e:
            self.refused.add(e["refused"])
        elif "again" in e:  # the test is another one now
            self.tests.pop(e["again"], None)
            for asked in self.asked.values():
                asked.pop(e["again"], None)
        elif "price" in e:
            self.tests[e["test"]] = e
        else:
            self.asked[e["mutant"]][e["test"]] = e["seconds"]
            if e["failed"]:
                self.killed[e["mutant"]] = e["test"]

    def add(self, **entry):
        self._take(entry)
        with open(self.file, "a", encoding="utf-8") as out:
            out.write(json.dumps(entry) + "\n")


def drawn(root, records, count):
    """(number, mutant); a number is a place in the draw."""
    every = enumerate(generate.sample(root, DRAWN), 1)
    return [(n, m) for n, m in every if m.choice and m.name not in records.refused][:count]


def write(root, copy, mutants):
    """Brings the copy up to date, with the mutants in it."""
    edits = collections.defaultdict(list)
    for number, m in mutants:
        for begin, end, text in m.choice:
            edits[m.file].append((begin, end, re.sub(r"\bON\b", f"::couplet_mutant::on({number})", text)))
    for folder, below, files in os.walk(root):
        here = pathlib.Path(folder).relative_to(root)
        below[:] = [name for name in below if not (name.startswith((".", "build")) and here == pathlib.Path("."))]
        for name in files:
            source, target, file = root / here / name, copy / here / name, (here / name).as_posix()
            text = source.read_bytes()
            if file in edits:
                text = text.decode()
                for begin, end, new in sorted(edits[file], key=lambda e: e[:2], reverse=True):
                    text = text[:begin] + new + text[end:]
                text = f'#include "{copy}/tests/mutants/choice.hpp"\n{text}'.encode()
            if not target.exists() or target.read_bytes() != text:
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(text)
                shutil.copymode(source, target)


def refuse(copy, records, mutants, log):
    """Leaves out the mutant that stands nearest before each error of the compiler."""
    known = {n: m.name for n, m in mutants}
    for file, line in sorted(set(re.findall(r"([\w./-]+\.[ch]pp):(\d+):\d+: error", log))):
        before = (copy / "build" / file).read_text().splitlines()[max(int(line) - 6, 0):int(line)]
        for n in re.findall(r"couplet_mutant::on\((\d+)\)", "\n".join(before))[-1:]:
            if known[int(n)] not in records.refused:
                records.add(refused=known[int(n)])


def build(root, copy, records, count):
    """Those that do not compile are left out, for the next of the draw."""
    while True:
        mutants = drawn(root, records, count)
        write(root, copy, mutants)
        if not (copy / "build").exists():
            subprocess.run(["cmake", "--preset", "release"], cwd=copy, check=True)
        done = subprocess.run(["ninja", "-C", "build", "-k", "0"], cwd=copy, capture_output=True, text=True, check=False)
        before = len(records.refused)
        refuse(copy, records, mutants, done.stdout)
        if done.returncode == 0:
            return
        if len(records.refused) == before:
            raise SystemExit(done.stdout[-3000:])


class Judge:
    def __init__(self, shop, records, mutants, limit):
        self.shop, self.records, self.mutants, self.limit = shop, records, mutants, limit
        self.page = pathlib.Path(tempfile.mkstemp(prefix="couplet-reached-")[1])

    def _run(self, test, most, number=0):
        self.page.write_bytes(bytes(4096))
        outcome = self.shop.run(test, self.shop.registered[test]["command"], most, COUPLET_MUTANT=str(number), COUPLET_REACHED=str(self.page))
        return outcome, self.page.read_bytes()

    def _price(self, test):
        known = self.records.tests.get(test)
        names = {m.name for _, m in self.mutants}
        if known and (known["price"] is None or names <= set(known["known"])):
            return known
        outcome, reached = self._run(test, MOST_OF_A_TEST)
        self.records.add(test=test, price=None if outcome.failed else round(outcome.seconds, 2), known=sorted(names),
                         reached=[m.name for n, m in self.mutants if reached[n]])
        return self.records.tests[test]

    def _ask(self, test, number, m, price):
        most = 4 * price + 5
        outcome, _ = self._run(test, most, number)
        if outcome.failed and self._run(test, most)[0].failed:  # it fails now and then without any
            print(f"UNSTEADY {test}", flush=True)
            self.records.add(test=test, price=None, known=[], reached=[])
            return
        self.records.add(mutant=m.name, test=test, seconds=round(outcome.seconds, 2), failed=outcome.failed)
        if outcome.failed:
            print(f"killed {number} {m.name} {m.file}:{m.line} {m.rule}: {m.shown} ({test})", flush=True)

    def __call__(self, tests):
        excused = reasons()
        for test in tests:
            alive = [(n, m) for n, m in self.mutants if m.name not in self.records.killed and m.name not in excused
                     and test not in (asked := self.records.asked[m.name]) and sum(asked.values()) < self.limit]
            if not alive:
                continue
            known = self._price(test)
            print(f"{test}: {known['price']} s, reaches {len(known['reached'])}", flush=True)
            for n, m in alive:
                if known["price"] is not None and m.name in known["reached"]:
                    self._ask(test, n, m, known["price"])
                    known = self.records.tests[test]


def quick(shop, records):
    """Tests of the quick suite, cheap ones first: by what they took here, or by ctest's own record."""
    def properties(entry):
        return {p["name"]: p["value"] for p in entry.get("properties", [])}

    costs = {}
    file = shop.build / "Testing/Temporary/CTestCostData.txt"
    for words in (line.split() for line in file.read_text().splitlines() if file.exists()):
        if len(words) == 3:
            costs[words[0]] = float(words[2])
    names = [t for t, e in shop.registered.items() if "long" not in properties(e).get("LABELS", []) and not properties(e).get("DISABLED")]
    return sorted(names, key=lambda t: (records.tests.get(t, {}).get("price") or costs.get(t, 3.0), t))


def reasons():
    """Names of the survivors that survivors.md gives a reason for."""
    return set(re.findall(r"^\| `([0-9a-f]{10})` \|", (pathlib.Path(__file__).resolve().parent / "survivors.md").read_text(), re.M))


def show(records, mutants):
    alive = [(n, m) for n, m in mutants if m.name not in records.killed]
    reached = {name for e in records.tests.values() for name in e["reached"]}
    for n, m in alive:
        why = "equivalent" if m.name in reasons() else f"{len(records.asked[m.name])} tests" if m.name in reached else "not reached"
        print(f"survived {n} {m.name} {m.file}:{m.line} {m.rule}: {m.shown} ({why})")
    equivalent = sum(m.name in reasons() for _, m in alive)
    print(f"{len(alive)} of {len(mutants)} mutants survive ({100 * len(alive) / len(mutants):.1f} %), {equivalent} of them equivalent, "
          f"over {len({m.file for _, m in mutants})} files; {len(records.refused)} do not compile")
    return 1 if len(alive) > 0.12 * len(mutants) or equivalent > 0.03 * len(mutants) else 0


def main():
    reader = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    reader.add_argument("root", type=pathlib.Path)
    reader.add_argument("copy", type=pathlib.Path)
    reader.add_argument("results", type=pathlib.Path)
    reader.add_argument("--sample", type=int, default=generate.SAMPLE)
    reader.add_argument("--limit", type=float, default=LIMIT)
    reader.add_argument("--tests", default="", help="only these")
    reader.add_argument("--again", help="tests that were changed")
    reader.add_argument("--only", choices=["write", "build", "judge", "show"])
    asked = reader.parse_args()
    root, copy, records = asked.root.resolve(), asked.copy.resolve(), Records(asked.results)
    if asked.only == "write":
        write(root, copy, drawn(root, records, asked.sample))
    if asked.only in (None, "build"):
        build(root, copy, records, asked.sample)
    mutants = drawn(root, records, asked.sample)
    if asked.only in (None, "judge"):
        shop = Workshop(copy, copy / "build")
        for test in [t for t in records.tests if asked.again and re.search(asked.again, t)]:
            records.add(again=test)
        Judge(shop, records, mutants, asked.limit)([t for t in quick(shop, records) if re.search(asked.tests, t)])
    return show(records, mutants) if asked.only in (None, "judge", "show") else 0


if __name__ == "__main__":
    sys.exit(main())
