# SPDX-License-Identifier: Apache-2.0
"""Bars of "fast again, and large": the lists of parts/fast_and_large/*.py."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("step", "start")
PARTS = [part for part in ORDER if (HERE / "parts" / "fast_and_large" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.fast_and_large.{part}").BARS]
NOTE = "\n\n".join(note for part in PARTS if (note := getattr(importlib.import_module(f"validation.parts.fast_and_large.{part}"), "NOTE", "")))
