# SPDX-License-Identifier: Apache-2.0
"""Bars of the linear thermoelastic solid: the lists of parts/solid/*.py, one after the other."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("cases", "conditions", "heat", "dynamics", "methods", "speed", "parallel")
PARTS = [part for part in ORDER if (HERE / "parts" / "solid" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.solid.{part}").BARS]
