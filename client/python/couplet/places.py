# SPDX-License-Identifier: Apache-2.0
"""Where programs, cases and documents lie: in a checkout of the project or below the prefix of an installation."""
import os
import pathlib

PACKAGE = pathlib.Path(__file__).resolve().parent
IN_CHECKOUT = (PACKAGE.parents[2] / "CMakeLists.txt").exists()
# Holds configs/ and docs/: the checkout, or share/couplet.
ROOT = PACKAGE.parents[2] if IN_CHECKOUT else PACKAGE.parents[1]


def build():
    """The folder whose bin/ holds the programs: that of COUPLET_BIN, build/ of a checkout, or the prefix."""
    if "COUPLET_BIN" in os.environ:
        return pathlib.Path(os.environ["COUPLET_BIN"]).absolute().parent
    return ROOT / "build" if IN_CHECKOUT else PACKAGE.parents[3]


def command():
    """The command `couplet` itself."""
    return ROOT / "scripts/couplet" if IN_CHECKOUT else PACKAGE.parents[3] / "bin/couplet"
