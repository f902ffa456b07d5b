# SPDX-License-Identifier: Apache-2.0
"""What many runs warned of, each warning once with the number of runs that gave it."""
import re

WARNING = re.compile(r"\] warning: (.*)")
NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")


def warnings_of(logs):
    """Lines for the end of a study: warnings of the runs' logs that differ in more than their numbers, with an example each."""
    found = {}  # without its numbers -> (example, runs)
    number = 0
    for log in logs:
        number += 1
        if not log.exists():
            continue
        seen = {}
        for text in WARNING.findall(log.read_text(errors="replace")):
            seen.setdefault(NUMBER.sub("#", text), text)
        for kind, text in seen.items():
            example, runs = found.get(kind, (text, 0))
            found[kind] = (example, runs + 1)
    return [f"warning in {runs} of {number} runs, for example: {example}" for example, runs in found.values()]
