#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Feeds the wrong configurations of table.py to the real programs: each must leave with exit code 2 and say exactly
what the table says. usage: run.py BIN_FOLDER [--show] [I/N] [NAME ...]   (--show prints what is said instead of comparing, I/N takes every N-th from the I-th on)"""
import difflib
import os
import re
import shutil
import subprocess
import sys
import tempfile

import table

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from checks import share  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))


def said(text):
    """What our program wrote to standard error, without what Open MPI adds when a job ends."""
    lines = []
    for line in text.splitlines():
        if line.startswith("-----"):
            break
        # "[host:1234] ..." is mpirun's, "[hwloc/linux] ..." comes in containers without /sys, "[solid 0] ..." is ours.
        if not re.match(r"\[\S+:\d+\] |\[hwloc/", line):
            lines.append(line.rstrip())
    return "\n".join(lines).strip()


def prepare(folder, case):
    shutil.copy(os.path.join(HERE, "square.msh"), folder)
    text = case.text
    if text is None:
        with open(os.path.join(HERE, case.base + ".yaml"), encoding="utf-8") as file:
            text = file.read()
        for old, new in case.edits:
            if text.count(old) != 1:
                raise SystemExit(f"{case.name}: '{old}' is in {case.base}.yaml {text.count(old)} times instead of once")
            text = text.replace(old, new)
    with open(os.path.join(folder, "case.yaml"), "w", encoding="utf-8") as file:
        file.write(text)
    for name, content in case.files.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(content)


def run(binaries, case):
    with tempfile.TemporaryDirectory(prefix="couplet-wrong-") as folder:
        prepare(folder, case)
        command = [os.path.join(binaries, case.program), *case.arguments]
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
        result.stderr = result.stderr.replace(os.path.join(os.path.realpath(folder), ""), "")
        return result


def compare(case, result):
    """Why the case failed, or nothing."""
    problems = []
    if result.returncode != case.exit_code:
        problems.append(f"exit code {result.returncode} instead of {case.exit_code}")
    got = said(result.stderr)
    if got != case.message.strip():
        problems += difflib.unified_diff(case.message.strip().splitlines(), got.splitlines(), "wanted", "got", lineterm="")
    return problems


def main():
    arguments = sys.argv[1:]
    show = "--show" in arguments
    arguments = [a for a in arguments if a != "--show"]
    cases = share(table.CASES, arguments)
    binaries, names = os.path.abspath(arguments[0]), arguments[1:]
    failed = 0
    for case in cases:
        if names and case.name not in names:
            continue
        result = run(binaries, case)
        if show:
            print(f"## {case.name}\n{said(result.stderr)}\n-> {result.returncode}\n")
            continue
        problems = compare(case, result)
        failed += bool(problems)
        print("FAILED" if problems else "ok    ", case.name)
        for line in problems:
            print("       ", line)
    print(f"{len(cases)} of {len(table.CASES)} cases; {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
