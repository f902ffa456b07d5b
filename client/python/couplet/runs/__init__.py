# SPDX-License-Identifier: Apache-2.0
"""Runs cases with the built programs and stores the costs and results of each run: the runner of the command `couplet`,
scripts/validate and benchmarks/."""
from couplet import lazy

PLACES = {
    "case": ("Case", "Wrong", "expect", "text_of"),
    "job": ("Job", "run"),
    "process": ("Cost", "RunFailed", "environment", "launch"),
    "pool": ("run_all", "warnings_of"),
    "results": ("Results", "read_csv"),
    "task": ("Record", "Task"),
}
__getattr__ = lazy.names(__name__, PLACES)
