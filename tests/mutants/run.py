#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Breaks the code on purpose, a line at a time, and asks whether the tests notice: of each mutant of mutants.py the one broken
file is compiled and linked before the library that has the sound one, and the test made so must fail. Neither the sources nor
the build are touched (but for the targets of the tests, which are brought up to date).
What survives shows a claim that no test holds.
Usage: run.py ROOT BUILD [NAME ...]   (BUILD: a configured build; NAME: only mutants whose name holds one of these)
       run.py ROOT --places            (only whether each line is where the mutant looks for it)"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import mutants


def text_of(*command, **options):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, check=True, **options).stdout


def places(root):
    """A mutant whose line was rewritten breaks nothing any more."""
    lost = [m for m in mutants.MUTANTS if (root / m.file).read_text().count(m.old) != 1]
    for m in lost:
        print(f"LOST     {m.name}: '{m.old}' is not once in {m.file}")
    print(f"{len(mutants.MUTANTS) - len(lost)} of {len(mutants.MUTANTS)} mutants have their place")
    return 1 if lost else 0


def compiled(root, build, mutant, commands, folder):
    """The object of the broken file, by the command that the build has for the sound one."""
    source = root / mutant.file
    broken, made = folder / source.name, folder / (source.name + ".o")
    broken.write_text(source.read_text().replace(mutant.old, mutant.new))
    words = next(shlex.split(c) for c in commands if c.endswith(f" -c {source}"))
    words[words.index("-o") + 1], words[words.index("-c") + 1] = str(made), str(broken)
    for option in ("-MT", "-MF"):  # the build's own record of what depends on what stays as it is
        place = words.index(option)
        del words[place:place + 2]
    words.remove("-MD")
    text_of(*words, "-iquote", source.parent, cwd=build)
    return made


def linked(build, commands, made, folder):
    """The test with the broken object before the libraries: their sound one is then not asked for."""
    words = [w for w in shlex.split(commands[-1]) if w not in (":", "&&")]
    test = folder / "test"
    sound = (build / words[words.index("-o") + 1]).resolve()
    words[words.index("-o") + 1] = str(test)
    first = next(k for k, w in enumerate(words) if w.endswith(".a"))
    words.insert(first, str(made))
    text_of(*words, cwd=build)
    return sound, test


def call_of(build, name):
    """Command, folder and environment of a registered test."""
    entry = next(t for t in json.loads(text_of("ctest", "--test-dir", build, "-R", f"^{name}$", "--show-only=json-v1"))["tests"])
    settings = {p["name"]: p["value"] for p in entry.get("properties", [])}
    more = dict(pair.split("=", 1) for pair in settings.get("ENVIRONMENT", []))
    return entry["command"], settings.get("WORKING_DIRECTORY", str(build)), {**os.environ, **more}, float(settings.get("TIMEOUT", 1500))


def fails(command, folder, environment, limit):
    """Whether the test fails (a run without end is noticed, too), and the first claim that it names."""
    try:
        result = subprocess.run(command, cwd=folder, env=environment, timeout=limit, capture_output=True, text=True, check=False)
    except subprocess.TimeoutExpired:
        return True, "it does not end"
    claim = re.search(r"^\[  FAILED  \] (\w+\.[\w/]+)", result.stdout, re.M)
    return result.returncode != 0, claim[1] if claim else f"exit code {result.returncode}"


def verdict_of(root, build, mutant):
    if (root / mutant.file).read_text().count(mutant.old) != 1:
        return "LOST", f"'{mutant.old}' is not once in {mutant.file}"
    text_of("ninja", "-C", build, mutant.target or mutant.test)
    command, where, environment, limit = call_of(build, mutant.test)
    if mutant.only:
        command = [*(w for w in command if not w.startswith("--gtest_filter")), f"--gtest_filter={mutant.only}"]
    if fails(command, where, environment, limit)[0]:
        return "RED BEFORE", mutant.test
    commands = text_of("ninja", "-C", build, "-t", "commands", mutant.target or mutant.test).splitlines()
    with tempfile.TemporaryDirectory(prefix="couplet-mutant-") as name:
        folder = pathlib.Path(name)
        sound, test = linked(build, commands, compiled(root, build, mutant, commands, folder), folder)
        broken = [str(test) if "/" in w and pathlib.Path(w).resolve() == sound else w for w in command]
        if broken == command:
            raise RuntimeError(f"{mutant.test} does not call {sound}")
        failed, claim = fails(broken, where, environment, limit)
    return ("killed", claim) if failed else ("SURVIVED", mutant.test)


def main():
    if sys.argv[2:] == ["--places"]:
        return places(pathlib.Path(sys.argv[1]).resolve())
    root, build, names = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    chosen = [m for m in mutants.MUTANTS if not names or any(n in m.name for n in names)]
    lost = []
    for mutant in chosen:
        verdict, what = verdict_of(root, build, mutant)
        print(f"{verdict:10} {mutant.name} ({what})", flush=True)
        if verdict != "killed":
            lost.append(mutant.name)
    print(f"{len(chosen) - len(lost)} of {len(chosen)} mutants are noticed" + (f"; not: {'; '.join(lost)}" if lost else ""))
    return 0 if chosen and not lost else 1


if __name__ == "__main__":
    sys.exit(main())
