# SPDX-License-Identifier: Apache-2.0
"""Measures of the mutants: how many the rules give, how many survive the quick tests of their folder, and the nine that none noticed."""
import os
import pathlib
import re

MOST = 0.15
# Of tests/mutants/mutants.py: one or more for each of the nine.
NINE = ("quasi-Newton", "the moments of a load", "the volume level on", "half the loss by mass damping", "thermal load of three-cornered",
        "friction of oblique faces", "not carried on to the centre of skew", "the load on the area", "error constant of the three-point")


def tool(job, name, *words, timeout=100000):
    return job.run(["/usr/bin/python3", job.root / "tests/mutants" / name, job.root, *words], timeout)


def places(job):
    result = tool(job, "run.py", "--places")
    drawn = re.search(r"^(\d+) mutants drawn", result.stdout, re.M)
    return "; ".join(result.stdout.strip().splitlines()[-2:]), result.returncode == 0 and drawn is not None and int(drawn[1]) >= 200


def nine(job):
    result = tool(job, "run.py", job.build, *NINE)
    missing = [n for n in NINE if not re.search(rf"^killed .*{re.escape(n)}", result.stdout, re.M)]
    last = (result.stdout.strip() or result.stderr.strip()).splitlines()[-1]
    return last + (f"; none killed of: {', '.join(missing)}" if missing else ""), result.returncode == 0 and not missing


def campaign(job):
    """Continues the results in the file that COUPLET_MUTANTS names, if one is given (a whole run takes hours of one core)."""
    file = pathlib.Path(os.environ.get("COUPLET_MUTANTS", job.root / "tests/mutants/judged.jsonl"))
    result = tool(job, "campaign.py", job.build, file)
    last = (result.stdout.strip() or result.stderr.strip()).splitlines()[-1]
    counts = re.search(r"(\d+) of (\d+) mutants survive", last)
    met = counts is not None and int(counts[2]) >= 200 and int(counts[1]) <= MOST * int(counts[2]) and result.returncode == 0
    return last, met
