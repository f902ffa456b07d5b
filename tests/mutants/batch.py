# SPDX-License-Identifier: Apache-2.0
"""Survivors once against the whole suite: a test is run with all of them together, and only where it fails with each alone."""
import pathlib
import subprocess
import tempfile

LIMIT = 600.0  # seconds of processor time of a test


class Objects:
    """Broken objects, each compiled once."""

    def __init__(self, shop, folder):
        self.shop, self.folder, self._known = shop, folder, {}

    def of(self, mutants):
        """One object a file, with all its mutants; of two that overlap the second is left for its own turn."""
        by_file = {}
        for m in mutants:
            by_file.setdefault(m.file, []).append(m)
        made, left = {}, []
        for file, group in by_file.items():
            chosen = []
            for m in sorted(group, key=lambda m: -m.begin):
                (left if chosen and m.end > chosen[-1].begin else chosen).append(m)
            key = (file, *(m.name for m in chosen))
            if key not in self._known:
                text = (self.shop.root / file).read_text()
                for m in chosen:
                    text = m.apply(text)
                place = self.folder / str(len(self._known))
                place.mkdir()
                self._known[key] = self.shop.compiled(file, text, place)
            made[file] = self._known[key]
        return made, left


def _fails(shop, objects, test, mutants):
    target = shop.target_of(test)
    chosen = [m for m in mutants if not target or shop.holds(target, m.file)]
    if not chosen:
        return False
    with tempfile.TemporaryDirectory(prefix="couplet-mutant-") as name:
        made, left = objects.of(chosen)
        command = shop.broken_command(test, list(made.values()), pathlib.Path(name), list(made))
        failed = command is not None and shop.run(test, command, LIMIT).failed
    return failed or (bool(left) and _fails(shop, objects, test, left))


def whole_suite(shop, records, survivors):
    with tempfile.TemporaryDirectory(prefix="couplet-mutants-") as name:
        _whole_suite(shop, Objects(shop, pathlib.Path(name)), records, survivors)


def _whole_suite(shop, objects, records, survivors):
    alive = list(survivors)
    for test, entry in shop.registered.items():
        labels = next((p["value"] for p in entry.get("properties", []) if p["name"] == "LABELS"), [])
        asked = [m for m in alive if test not in records.mutants[m.name]["asked"]]
        if "long" in labels or not asked or any("fuzz" in w for w in [test]):
            continue
        try:
            noticed = _fails(shop, objects, test, asked)
            if noticed and shop.run(test, entry["command"], LIMIT).failed:
                print(f"RED BEFORE   {test}", flush=True)
                continue
            killed = [m for m in asked if _fails(shop, objects, test, [m])] if noticed else []
        except subprocess.CalledProcessError as error:
            print(f"NOT LINKED   {test}: {error.stderr[-200:]}", flush=True)
            continue
        print(f"{len(killed)} of {len(asked)} noticed by {test}", flush=True)
        for m in killed:
            alive.remove(m)
            records.add({**records.mutants[m.name], "suite": test})
            print(f"suite        {m.name} {m.file}:{m.line} ({test})", flush=True)
    for m in alive:
        records.add({**records.mutants[m.name], "suite": ""})
