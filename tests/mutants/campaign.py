#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Which generated mutants survive the quick tests of their folder: each is compiled alone, linked before the libraries of the
build, and given to the tests nearest to it until one fails. What has been judged is kept in a file of JSON lines and not judged again.
Usage: campaign.py ROOT BUILD RESULTS [--sample N] [--seed S] [--workers N] [--only TEXT] [--again] [--batch-survivors]"""
import argparse
import concurrent.futures
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

import generate
import nearest
from batch import whole_suite
from workshop import Workshop

BUDGET = 60.0  # seconds of processor time for the tests of a mutant
LARGEST_SHARE = 0.15
HERE = pathlib.Path(__file__).resolve().parent


class Records:
    """What is known, by the names of mutants and tests; the last word counts."""

    def __init__(self, file):
        self.file, self.lock, self.mutants, self.prices = file, threading.Lock(), {}, {}
        if file.exists():
            for line in file.read_text().splitlines():
                self._take(json.loads(line))

    def _take(self, entry):
        if "price" in entry:
            self.prices[entry["test"]] = entry["price"]
        else:
            self.mutants[entry["name"]] = entry

    def add(self, entry):
        with self.lock:
            self._take(entry)
            with open(self.file, "a", encoding="utf-8") as out:
                out.write(json.dumps(entry) + "\n")


def priced(shop, records, tests):
    """What sound tests take; one that fails without any mutant says nothing and is not asked."""
    for test in tests:
        if test in records.prices:
            continue
        outcome = shop.run(test, shop.registered[test]["command"], BUDGET)
        if not outcome.failed or outcome.stopped:
            records.add({"test": test, "price": round(outcome.seconds, 2)})
        print(f"{outcome.seconds:7.1f} s {test}{' FAILS' if outcome.failed else ''}", flush=True)


def claim_of(outcome):
    found = re.search(r"^\[  FAILED  \] (\w+[.\w/]+)", outcome.text, re.M)
    return found[1] if found else "it does not end" if outcome.stopped else ""


class Judge:
    def __init__(self, shop, records):
        self.shop, self.records, self._codes, self._lock = shop, records, {}, threading.Lock()

    def _sound_code(self, file, folder):
        with self._lock:
            if file not in self._codes:
                self._codes[file] = hash(self.shop.code(self.shop.object_of(file), folder))
            return self._codes[file]

    def _asked(self, m, made, folder):
        """(verdict, by what, tests asked, processor time)"""
        spent, asked = 0.0, []
        prices = self.records.prices
        before = self.records.mutants.get(m.name, {}).get("asked", [])
        in_order = sorted(nearest.tests_of(m.file, self.shop.registered, prices), key=lambda t: t in before)  # what is new first
        for test in in_order:
            price = prices.get(test)
            target = self.shop.target_of(test)
            if price is None or spent + price > BUDGET or (target and not self.shop.holds(target, m.file)):
                continue
            try:
                command = self.shop.broken_command(test, [made], folder, [m.file])
            except subprocess.CalledProcessError as error:
                return "not linked", error.stderr[-300:], asked, spent
            if command is None:
                continue
            outcome = self.shop.run(test, command, 4 * price + 5)
            asked.append(test)
            spent += outcome.seconds
            if outcome.failed:
                return "killed", f"{test} {claim_of(outcome)}".strip(), asked, spent
        return "survived", "", asked, spent

    def __call__(self, m):
        source = (self.shop.root / m.file).read_text()
        with tempfile.TemporaryDirectory(prefix="couplet-mutant-") as name:
            folder = pathlib.Path(name)
            begin = time.monotonic()
            sound = self._sound_code(m.file, folder)
            try:
                made = self.shop.compiled(m.file, m.apply(source), folder)
            except subprocess.CalledProcessError as error:
                if "error:" not in error.stderr:  # the compiler was ended from outside
                    return "interrupted", "", [], 0
                verdict = ("not compiled", re.sub(r"\s+", " ", error.stderr)[:200], [], 0)
            else:
                same = hash(self.shop.code(made, folder)) == sound
                verdict = ("equivalent", "", [], 0) if same else self._asked(m, made, folder)
        self.records.add({"name": m.name, "file": m.file, "line": m.line, "kind": m.kind, "rule": m.rule, "shown": m.shown, "verdict": verdict[0],
                          "by": verdict[1], "asked": verdict[2], "seconds": round(verdict[3], 1), "clock": round(time.monotonic() - begin)})
        return verdict


def summary(drawn, records):
    counts = {}
    for m in drawn:
        verdict = records.mutants.get(m.name, {}).get("verdict", "not judged")
        counts[verdict] = counts.get(verdict, 0) + 1
    judged = counts.get("killed", 0) + counts.get("survived", 0)
    share = counts.get("survived", 0) / judged if judged else 1
    text = f"{counts.get('survived', 0)} of {judged} mutants survive ({100 * share:.1f} %)"
    return text + "".join(f"; {n} {v}" for v, n in sorted(counts.items()) if v not in ("killed", "survived")), judged, share


def reasons():
    """Names of the survivors that survivors.md gives a reason for."""
    return set(re.findall(r"^\| `([0-9a-f]{10})` \|", (HERE / "survivors.md").read_text(), re.M))


def arguments():
    reader = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    reader.add_argument("root", type=pathlib.Path)
    reader.add_argument("build", type=pathlib.Path)
    reader.add_argument("results", type=pathlib.Path)
    reader.add_argument("--sample", type=int, default=generate.SAMPLE)
    reader.add_argument("--seed", type=int, default=generate.SEED)
    reader.add_argument("--workers", type=int, default=1)
    reader.add_argument("--only", default="", help="mutants whose name or file holds this")
    reader.add_argument("--again", action="store_true", help="survivors of before that have no reason are judged again")
    reader.add_argument("--batch-survivors", action="store_true", help="survivors once against the whole suite")
    return reader.parse_args()


def main():
    asked = arguments()
    shop, records = Workshop(asked.root.resolve(), asked.build.resolve()), Records(asked.results)
    drawn = generate.sample(shop.root, asked.sample, asked.seed)
    chosen = [m for m in drawn if asked.only in m.name or asked.only in m.file]
    if asked.batch_survivors:
        whole_suite(shop, records, [m for m in chosen if records.mutants.get(m.name, {}).get("verdict") == "survived"])
    else:
        known = records.mutants
        excused = reasons()
        todo = [m for m in chosen if m.name not in known or (asked.again and known[m.name]["verdict"] == "survived" and m.name not in excused)]
        todo.sort(key=lambda m: m.name in known)  # what is new first
        priced(shop, records, dict.fromkeys(t for m in todo for t in nearest.tests_of(m.file, shop.registered, {})))
        judge = Judge(shop, records)
        with concurrent.futures.ThreadPoolExecutor(asked.workers) as pool:
            for m, (verdict, by, _, seconds) in zip(todo, pool.map(judge, todo)):
                print(f"{verdict:12} {m.name} {m.file}:{m.line} {m.rule}: {m.shown}" + (f" ({by}, {seconds:.0f} s)" if by else ""), flush=True)
    text, judged, share = summary(drawn, records)
    bare = [m for m in drawn if records.mutants.get(m.name, {}).get("verdict") == "survived" and m.name not in reasons()]
    for m in bare:
        print(f"SURVIVED without a reason in survivors.md: {m.name} {m.file}:{m.line} {m.rule}: {m.shown}")
    print(f"{text}; {len(bare)} of the survivors without a reason")
    whole = all(m.name in records.mutants for m in drawn)
    return 0 if whole and judged and share <= LARGEST_SHARE and not bare else 1


if __name__ == "__main__":
    sys.exit(main())
