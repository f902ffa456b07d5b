# SPDX-License-Identifier: Apache-2.0
"""What the end of a run tells: main numbers with and without an error."""
import json

CASES = (
    ("cantilever", ()),
    ("elliptic-plate", ()),
    ("le1", ()),
    ("vibrating-cantilever", ("simulation.end-time=10 s",)),
    ("tuning-fork", ()),
    ("heated-cylinder", ()),
    ("plate-square", ()),
    ("cavity", ("simulation.end-time=2 s",)),
    ("taylor-couette", ("simulation.end-time=1 s",)),
    ("schumann", ()),
    ("perpendicular-flap", ("simulation.end-time=0.2 s",)),
)


def numbers_with_an_error(job, least):
    """Share of the numbers that a case asks for, or that follow from it, which are printed with an estimated error."""
    known, total, missing = 0, 0, {}
    for case, sets in CASES:
        for file in job.case(case, sets).folder.glob("*/run.json"):
            for row in json.loads(file.read_text())["results"]:
                if row["rank"] > 1 or row["error"] is None and "unknown" not in row["text"]:
                    continue
                total += 1
                known += row["error"] is not None
                if row["error"] is None:
                    missing[row["unit"]] = missing.get(row["unit"], 0) + 1
    most = ", ".join(f"{n} in {unit}" for unit, n in sorted(missing.items(), key=lambda item: -item[1])[:4])
    return f"{known} of {total}, {100 * known / total:.0f} %; without: {most}", known >= least * total
