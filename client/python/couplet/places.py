# SPDX-License-Identifier: Apache-2.0
"""Locations of programs, cases and documents, in a checkout of the project or below the prefix of an installation."""
import os
import pathlib

PACKAGE = pathlib.Path(__file__).resolve().parent
IN_CHECKOUT = (PACKAGE.parents[2] / "CMakeLists.txt").exists()
# Folder with configs/ and docs/: the checkout, or share/couplet.
ROOT = PACKAGE.parents[2] if IN_CHECKOUT else PACKAGE.parents[1]


def build():
    """Folder whose bin/ contains the programs: COUPLET_BIN, build/ of a checkout, or the prefix."""
    if "COUPLET_BIN" in os.environ:
        return pathlib.Path(os.environ["COUPLET_BIN"]).absolute().parent
    return ROOT / "build" if IN_CHECKOUT else PACKAGE.parents[3]


def command():
    """Path of the command `couplet`."""
    return ROOT / "scripts/couplet" if IN_CHECKOUT else PACKAGE.parents[3] / "bin/couplet"
