#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the mistakes of table.py with the real programs and asserts what becomes of each: refused, flagged or right.
usage: run.py BIN_FOLDER [--show] [I/N] [GROUP or NAME ...]   (I/N: every N-th from the I-th on)"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import table

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support"))
from checks import COUPLED, mpmd, share  # noqa: E402

os.environ["OMPI_MCA_rmaps_base_oversubscribe"] = "1"


def prepare(folder, mistake):
    for mesh in HERE.glob("*.msh"):
        shutil.copy(mesh, folder)
    text = mistake.case.read_text(encoding="utf-8")
    for old, new in mistake.edits:
        if text.count(old) != 1:
            raise SystemExit(f"{mistake.name}: '{old}' is in {mistake.base}.yaml {text.count(old)} times instead of once")
        text = text.replace(old, new)
    (folder / "case.yaml").write_text(text, encoding="utf-8")
    for name, content in mistake.files.items():
        (folder / name).write_text(content, encoding="utf-8")


def call(binaries, folder, mistake, more):
    words = [binaries / table.PROGRAMS[mistake.base], "case.yaml", *more]
    if mistake.base == "coupled" and mistake.run:
        words = mpmd([binaries / program, "case.yaml", *more] for program in COUPLED)
    result = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    return result.returncode, result.stdout + result.stderr


def problems(binaries, mistake):
    """What differs from what the table says, and what the program said."""
    with tempfile.TemporaryDirectory(prefix="couplet-mistakes-") as folder:
        folder = pathlib.Path(folder)
        prepare(folder, mistake)
        how = [*([] if mistake.run else ["--check"]), *(f"--set=participants.{mistake.base}.{word}" for word in mistake.set)]
        code, text = call(binaries, folder, mistake, how)
        if mistake.twice is not None:
            if code != 0:
                return [f"the first run ends with exit code {code}"], text
            code, text = call(binaries, folder, mistake, how + mistake.twice)
        wanted = mistake.code if mistake.code is not None else {table.REFUSED: 2, table.FLAGGED: 0, table.RIGHT: 0}[mistake.outcome]
        bad = [] if code == wanted else [f"exit code {code} instead of {wanted}"]
        if mistake.outcome != table.RIGHT and mistake.message not in text:
            bad.append(f"it does not say '{mistake.message}'")
        if mistake.says not in text:
            bad.append(f"it does not say '{mistake.says}'")
        if mistake.outcome == table.FLAGGED and "warning:" not in text:
            bad.append("it does not warn")
        if mistake.outcome == table.RIGHT and ("implausible" in text or not mistake.message):
            bad.append("it is flagged, or the table does not say why it is right")
        return bad, text


def main():
    words = [w for w in sys.argv[1:] if w != "--show"]
    mistakes = share([(group, mistake) for group, mistakes in table.MISTAKES.items() for mistake in mistakes], words)
    show, binaries, chosen = "--show" in sys.argv, pathlib.Path(words[0]).resolve(), words[1:]
    tried = failed = 0
    for group, mistake in mistakes:
        if chosen and group not in chosen and mistake.name not in chosen:
            continue
        bad, text = problems(binaries, mistake)
        tried, failed = tried + 1, failed + bool(bad)
        print(f"{'FAILED' if bad else 'ok    '} {mistake.outcome:8} {mistake.name}", *bad, sep="\n         ")
        if show:
            print("\n".join(line[:400] for line in text.splitlines() if any(w in line for w in ("warn", "error", "case.yaml", "WARN")))[-1500:])
    print(f"{tried} mistakes, {failed} with another outcome than the table's")
    return 1 if failed or not tried else 0


if __name__ == "__main__":
    sys.exit(main())
