# SPDX-License-Identifier: Apache-2.0
"""Runs cases with the built programs and keeps what each run cost and gave: one runner for scripts/study, scripts/accuracy,
scripts/validate and benchmarks/."""
from couplet_run.case import Case, Wrong, expect, text_of  # noqa: F401
from couplet_run.launch import Cost, RunFailed, environment, launch  # noqa: F401
from couplet_run.pool import run_all  # noqa: F401
from couplet_run.results import Results  # noqa: F401
from couplet_run.task import Record, Task  # noqa: F401
from couplet_run.warnings import warnings_of  # noqa: F401
