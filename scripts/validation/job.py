# SPDX-License-Identifier: Apache-2.0
"""How a bar gets its numbers: from the project's programs, test executables and scripts, never from a model beside
them."""
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
from typing import Callable

from couplet.runs import Case, Cost, Results, RunFailed, environment, launch
from couplet.study.quantities import module

KEPT = "validated.json"  # in the folder of a kept run: what it was made of, and its cost


@dataclasses.dataclass
class Bar:
    quantity: str
    wanted: str
    # (job) -> (got, met); met is None where the row only reports ('wanted' begins with "reported" then, too)
    measure: Callable
    long: bool = False  # takes more than a minute: left out by --quick
    but: str = ""  # how case, mesh, reading or statistic differ from what was first asked for, and why
    sources: tuple = ()  # folders whose change may change this row; those of its table if none are given

    @property
    def text(self):
        """Text of the wanted value in the table."""
        return f"{self.wanted} (differs from the original request: {self.but})" if self.but else self.wanted


def made_of(command, folder):
    """A digest of the words of a command, of the files that they name and of the case's own."""
    digest = hashlib.sha256()
    for word in map(str, command):
        digest.update(word.encode() + b"\0")
    named = [pathlib.Path(w) for w in map(str, command) if os.path.isfile(w)]
    for file in sorted({*named, *(f for f in folder.iterdir() if f.is_file() and ".cache." not in f.name)}):
        digest.update(file.read_bytes())
    return digest.hexdigest()


def was_kept(out, identity):
    return (out / KEPT).exists() and json.loads((out / KEPT).read_text())["of"] == identity


class Job:
    """Paths, a scratch folder, and results that several bars share (each made once). With `keep`, a folder, runs of
    cases stay there, and one that the same programs made of the same case is not repeated."""

    def __init__(self, root, build, quick, keep=None):
        self.root, self.build, self.quick, self.keep, self._kept = root, build, quick, keep, {}
        self.environment = environment()

    def __enter__(self):
        if self.keep:
            self.keep.mkdir(parents=True, exist_ok=True)
        self.scratch = self.keep or pathlib.Path(tempfile.mkdtemp(prefix="couplet-validate-"))
        return self

    def __exit__(self, *_):
        if not self.keep:
            shutil.rmtree(self.scratch, ignore_errors=True)

    def once(self, key, make):
        """Returns the result of make() or raises its exception again, so that a run of hours is not repeated for every
        row that reads it."""
        if key not in self._kept:
            try:
                self._kept[key] = make()
            except Exception as failure:
                self._kept[key] = failure
        if isinstance(self._kept[key], Exception):
            raise self._kept[key]
        return self._kept[key]

    def run(self, command, timeout=1800, **options):
        return subprocess.run(
            [str(c) for c in command], capture_output=True, text=True, timeout=timeout, env=self.environment, **options
        )

    def done(self, command, timeout=1800, **options):
        """Runs a command in the same way. Raises an error with the end of its output if it fails."""
        result = self.run(command, timeout, **options)
        if result.returncode != 0:
            last = (result.stderr.strip() or result.stdout.strip())[-300:]
            raise RuntimeError(f"{pathlib.Path(command[0]).name} ended with code {result.returncode}: {last}")
        return result

    # -- test executables ---------------------------------------------------------------------------------------------
    @functools.cached_property
    def registered(self):
        """Returns {test of ctest: the words of its command}."""
        return {
            t["name"]: t.get("command", [])
            for t in json.loads(self.done(["ctest", "--test-dir", self.build, "--show-only=json-v1"], 120).stdout)[
                "tests"
            ]
        }

    def test(self, name):
        """The words that run a registered test on one rank: its executable, and whose tests of it (`--only`)."""
        words = next((self.registered[n] for n in (name, f"{name}_2", f"{name}_3") if n in self.registered), [])
        first = next(
            (k for k, w in enumerate(words) if w.startswith(f"{pathlib.Path(self.build).resolve()}/tests/")), None
        )
        if first is None or not os.access(words[first], os.X_OK):
            raise FileNotFoundError(f"the executable of test {name} is not built")
        return [w for w in words[first:] if not w.startswith("--gtest_filter")]

    def gtest(self, name, filter_="*", timeout=7200, count=None):
        """Runs a test executable (a fuzz program at `count` inputs); gives {"Suite.test": {"passed": bool, **recorded
        properties}} and its output."""

        def make():
            file = self.scratch / f"{name}-{count}.json"
            inputs = ["env", f"COUPLET_FUZZ_COUNT={count}"] if count else []
            result = self.run(
                [*inputs, *self.test(name), f"--gtest_filter={filter_}", f"--gtest_output=json:{file}"],
                timeout,
                cwd=self.scratch,
            )
            if not file.exists():
                raise RuntimeError(f"{name} ended with code {result.returncode}: {result.stdout[-200:]}")
            known, tests = {
                "name",
                "value_param",
                "type_param",
                "status",
                "result",
                "timestamp",
                "time",
                "classname",
                "failures",
                "file",
                "line",
            }, {}
            for suite in json.loads(file.read_text())["testsuites"]:
                for test in suite["testsuite"]:
                    if test.get("result") != "SKIPPED":  # does not apply to this mesh: says nothing about a bar
                        tests[f"{suite['name']}.{test['name']}"] = {
                            "passed": not test.get("failures") and test.get("result") == "COMPLETED",
                            **{k: v for k, v in test.items() if k not in known},
                        }
            if not tests:
                raise LookupError(f"{name} has no test {filter_}")
            return tests, result.stdout

        return self.once(("gtest", name, filter_, count), make)

    def recorded(self, name, pattern, key):
        """All values of a recorded property in the tests whose name matches, and whether all those tests passed."""
        tests, _ = self.gtest(name)
        chosen = {t: v for t, v in tests.items() if re.search(pattern, t)}
        values = [float(v[key]) for v in chosen.values() if key in v]
        if not values:
            raise LookupError(f"no test of {name} matching '{pattern}' recorded '{key}'")
        return values, all(v["passed"] for v in chosen.values())

    def ctest(self, pattern, timeout=1800):
        """Runs registered tests by name; gives (passed, total, skipped, output)."""

        def make():
            result = self.run(["ctest", "--test-dir", self.build, "-R", pattern, "-V"], timeout)
            passed = len(re.findall(r"^\s*\d+/\d+ Test.*\bPassed\b", result.stdout, flags=re.M))
            skipped = len(re.findall(r"\*\*\*Skipped", result.stdout))
            total = len(re.findall(r"^\s*\d+/\d+ Test ", result.stdout, flags=re.M))
            return passed, total, skipped, result.stdout

        return self.once(("ctest", pattern), make)

    # -- programs -----------------------------------------------------------------------------------------------------
    def case_run(self, case, out, overrides, ranks, timeout, flags=()):
        """Runs a case into a folder; gives its Results with `cost` and `log`. `ranks`: ranks of each participant;
        `flags`: further arguments of all programs. A failure has what was written until then as its `results`."""
        command = Case(case, self.build).command(
            {"simulation.output.folder": str(out)}, ranks=ranks, raw=overrides, flags=flags
        )
        identity = self.keep and made_of(command, pathlib.Path(case).parent)
        if self.keep and not was_kept(out, identity):
            shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True, exist_ok=True)
        results = Results(out)
        if self.keep and was_kept(out, identity):
            results.cost = Cost(*json.loads((out / KEPT).read_text())["cost"])
        else:
            try:
                results.cost = launch(command, out / "run.log", timeout=timeout)
            except RunFailed as failure:
                failure.results = results
                raise
            if self.keep:
                (out / KEPT).write_text(json.dumps({"of": identity, "cost": dataclasses.astuple(results.cost)}))
        results.log = (out / "run.log").read_text(errors="replace")
        return results

    def case(self, case, keys=(), ranks=(), timeout=3600, flags=()):
        """Results of configs/<case>: a folder, a file 'folder/name' of it, or a path that ends in .yaml. `participant`
        is its first one; a key '.key' is one of that participant. `ranks`: ranks of the coupler and of the participants
        in their order, or one number for the only participant. Runs with the same keys are made once."""

        def make():
            file = self.root / (
                case
                if case.endswith(".yaml")
                else f"configs/{case}.yaml" if "/" in case else f"configs/{case}/case.yaml"
            )
            participants = list(Case(file).participants)
            participant = participants[0]
            words = [f"participants.{participant}{k}" if k.startswith(".") else k for k in keys]
            by_name = {participant: ranks} if isinstance(ranks, int) else dict(zip(["coupler", *participants], ranks))
            name = hashlib.sha256(repr((case, tuple(keys), ranks, flags)).encode()).hexdigest()[:12]
            results = self.case_run(file, self.scratch / f"run-{name}", words, by_name, timeout, flags)
            results.participant = participant
            return results

        return self.once(("case", case, tuple(keys), ranks, flags), make)

    def beside(self, file):
        """A Python file of a case, such as configs/<case>/errors.py, as a module."""
        return module(str(self.root / file))
