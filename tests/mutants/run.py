#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Breaks the code on purpose, a line at a time, and asks whether the tests notice: each mutant of mutants.py is built and
tested in a copy of the tree, and must make its test fail. What survives shows a claim that no test holds.
Usage: run.py ROOT BUILD [NAME ...]   (BUILD: a configured build whose options the copy takes; NAME: only these mutants)
       run.py ROOT --places            (only whether each line is where the mutant looks for it)"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import mutants


def option(cache, name):
    found = re.search(rf"^{name}:\w+=(.*)$", cache, re.M)
    return found[1] if found else ""


def places(root):
    """A mutant whose line was rewritten breaks nothing any more."""
    lost = [m for m in mutants.MUTANTS if (root / m.file).read_text().count(m.old) != 1]
    for m in lost:
        print(f"LOST     {m.name}: '{m.old}' is not once in {m.file}")
    print(f"{len(mutants.MUTANTS) - len(lost)} of {len(mutants.MUTANTS)} mutants have their place")
    return 1 if lost else 0


def main():
    if sys.argv[2:] == ["--places"]:
        return places(pathlib.Path(sys.argv[1]).resolve())
    root, build, names = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3:]
    chosen = [m for m in mutants.MUTANTS if not names or m.name in names]
    killed = 0
    with tempfile.TemporaryDirectory(prefix="couplet-mutants-", dir=root.parent) as name:
        copy = pathlib.Path(name)
        os.environ.update(CCACHE_BASEDIR=name, CCACHE_NOHASHDIR="1")  # the folder's name is another one each time
        files = subprocess.run(["git", "-C", root, "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
        for file in filter(None, files.split("\0")):
            (copy / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / file, copy / file)
        cache = (build / "CMakeCache.txt").read_text()
        options = [f"-D{o}={option(cache, o)}" for o in ("CMAKE_BUILD_TYPE", "CMAKE_CXX_COMPILER_LAUNCHER", "COUPLET_WERROR") if option(cache, o)]
        subprocess.run(["cmake", "-S", copy, "-B", copy / "build", "-G", "Ninja", *options], check=True, stdout=subprocess.DEVNULL)
        for mutant in chosen:
            file = copy / mutant.file
            sound = file.read_text()
            if sound.count(mutant.old) != 1:
                print(f"LOST     {mutant.name}: '{mutant.old}' is in {mutant.file} {sound.count(mutant.old)} times instead of once")
                continue
            build_it = ["ninja", "-C", copy / "build", "-j2", mutant.test]
            test_it = ["ctest", "--test-dir", copy / "build", "-R", f"^{mutant.test}$"]
            subprocess.run(build_it, check=True, stdout=subprocess.DEVNULL)
            before = subprocess.run(test_it, capture_output=True, check=False).returncode
            file.write_text(sound.replace(mutant.old, mutant.new))
            subprocess.run(build_it, check=True, stdout=subprocess.DEVNULL)
            after = subprocess.run(test_it, capture_output=True, check=False).returncode
            file.write_text(sound)
            verdict = "killed" if before == 0 and after != 0 else "SURVIVED" if before == 0 else "RED BEFORE"
            killed += verdict == "killed"
            print(f"{verdict:8} {mutant.name} ({mutant.test})", flush=True)
    print(f"{killed} of {len(chosen)} mutants are noticed")
    return 0 if killed == len(chosen) else 1


if __name__ == "__main__":
    sys.exit(main())
