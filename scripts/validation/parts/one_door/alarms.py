# SPDX-License-Identifier: Apache-2.0
"""False alarms: findings of every shipped case with its default settings."""
from validation.job import Bar
from validation.parts.trust.runs import script

BARS = [
    Bar("shipped cases with --strict=effects: every finding is defended in docs/findings.md, none is `wrong`", "0 not defended, 0 wrong",
        script("tests/cli/alarms/run.py", "{bin}", "{root}", "--json", "{bin}/../alarms.json"), long=True,
        but="cases that take longer than 40 s are stopped by a signal there, and their findings until then count"),
]
