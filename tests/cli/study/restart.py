#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A tank with a plant that goes on from a checkpoint writes the same reports as one that ran through. usage: restart.py BIN"""
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests/cli/wrong"), str(ROOT / "tests/support")]
import table
from checks import said

WEATHER = next(c.files for c in table.CASES if c.name == "right plant")
FILES = ("summary.csv", "days.csv", "plant.csv")


def run(program, folder, *options):
    said([program, "case.yaml", *options], cwd=folder)


def main(program):
    failed = 0
    with tempfile.TemporaryDirectory(prefix="couplet-restart-") as name:
        folder = pathlib.Path(name)
        text = (ROOT / "tests/cli/wrong/plant.yaml").read_text()
        text = text.replace("time-step: 15 min}", "time-step: 15 min, checkpoint: {interval: 9 h, keep: 9}}").replace("1 day,", "2 day,")
        (folder / "case.yaml").write_text(text)
        for file, content in WEATHER.items():
            (folder / file).write_text(content)
        run(program, folder)
        whole = {file: (folder / "out/tank" / file).read_text() for file in FILES}
        # In the middle of the second day's charge.
        run(program, folder, "--restart", "out/checkpoints/step-00000144")
        for file in FILES:
            again = (folder / "out/tank" / file).read_text()
            same = again == whole[file] and len(again.splitlines()) > 2
            print("ok    " if same else "FAILED", file)
            failed += not same
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
