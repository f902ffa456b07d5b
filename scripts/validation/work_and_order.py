# SPDX-License-Identifier: Apache-2.0
"""Bars of "coupling that keeps its work and its order": the lists of parts/work_and_order/*.py."""
import importlib
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
ORDER = ("maps", "damping", "loads", "ladder", "tolerances", "effort", "data", "restart", "light", "again")
PARTS = [part for part in ORDER if (HERE / "parts" / "work_and_order" / f"{part}.py").exists()]
BARS = [bar for part in PARTS for bar in importlib.import_module(f"validation.parts.work_and_order.{part}").BARS]
