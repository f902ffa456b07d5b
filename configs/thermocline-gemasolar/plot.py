#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws out/thermocline-gemasolar.png from what scripts/couplet study has left in out/study."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "client/python"))
import figures  # noqa: E402

print(figures.picture(HERE, 23, "Case G: Gemasolar, 19.9 MW, 290 to 565 °C"))
