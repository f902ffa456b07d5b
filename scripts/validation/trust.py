# SPDX-License-Identifier: Apache-2.0
"""Bars of "nothing wrong leaves with exit code 0": the lists of parts/trust/*.py, a file for each part of the program."""
import importlib
import pathlib

from validation.parts.trust import items as trust_items

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("fluid", "coupler", "solid", "runs", "tank", "tests", "house")
PARTS = [part for part in ORDER if (HERE / "parts" / "trust" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.trust.{part}").BARS]
BARS += trust_items.rows(BARS)


def items():
    return trust_items.table(BARS)
