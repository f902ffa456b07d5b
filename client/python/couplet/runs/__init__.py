# SPDX-License-Identifier: Apache-2.0
"""Runs cases with the built programs and keeps what each run cost and gave: one runner for the command `couplet`,
scripts/validate and benchmarks/."""
from couplet.runs.case import Case, Wrong, expect, text_of  # noqa: F401
from couplet.runs.job import Job, run  # noqa: F401
from couplet.runs.launch import Cost, RunFailed, environment, launch  # noqa: F401
from couplet.runs.pool import run_all  # noqa: F401
from couplet.runs.results import Results, read_csv  # noqa: F401
from couplet.runs.task import Record, Task  # noqa: F401
from couplet.runs.warnings import warnings_of  # noqa: F401
