# SPDX-License-Identifier: Apache-2.0
"""What tests that run programs share: claims that are told one by one, and the last row of a table."""
import sys

failed = []


def check(claim, holds, detail=""):
    print(f"{'ok' if holds else 'not ok'}  {claim}  {detail}", flush=True)
    if not holds:
        failed.append(claim)


def last(file):
    """Columns by name without its unit."""
    names, *rows = [line.split(",") for line in file.read_text().splitlines()]
    return dict(zip((n.split(" [")[0] for n in names), map(float, rows[-1])))


def end():
    sys.exit(1 if failed else 0)
