# SPDX-License-Identifier: Apache-2.0
"""Bars of the thermocline tank: the lists of parts/thermocline/*.py, one after the other."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("elements", "plant", "wall")
PARTS = [part for part in ORDER if (HERE / "parts" / "thermocline" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.thermocline.{part}").BARS]
