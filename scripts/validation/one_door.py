# SPDX-License-Identifier: Apache-2.0
"""Bars of "one door for foreign data, contracts for roles, verdicts that act": the lists of parts/one_door/*.py."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("data", "tables", "gmsh", "roles", "quantities", "verdicts", "alarms", "mutants", "strikes")
PARTS = [part for part in ORDER if (HERE / "parts" / "one_door" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.one_door.{part}").BARS]
