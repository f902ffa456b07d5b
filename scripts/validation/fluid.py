# SPDX-License-Identifier: Apache-2.0
"""Bars of the fluid: the lists of parts/fluid/*.py, one after the other."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("orders", "cases", "effects", "speed")
PARTS = [part for part in ORDER if (HERE / "parts" / "fluid" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.fluid.{part}").BARS]
