# SPDX-License-Identifier: Apache-2.0
"""What tests that run programs share: claims that are reported one by one, and the last row of a table."""
import sys

failed = []


def check(claim, holds, detail=""):
    """Gives whether the claim failed."""
    print(f"{'ok' if holds else 'not ok'}  {claim}  {detail}", flush=True)
    if not holds:
        failed.append(claim)
    return not holds


def require(claim, holds, detail=""):
    """A claim without which the rest is not worth a run."""
    if check(claim, holds, detail):
        end()


def last(file):
    """Columns by name without its unit."""
    names, *rows = [line.split(",") for line in file.read_text().splitlines()]
    return dict(zip((n.split(" [")[0] for n in names), map(float, rows[-1])))


def end():
    print(f"{len(failed)} checks failed" if failed else "all checks passed")
    sys.exit(1 if failed else 0)
