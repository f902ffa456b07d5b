# SPDX-License-Identifier: Apache-2.0
"""Locations of programs, cases and documents: in a checkout of the project, below the prefix of an installation, or,
for a package installed by pip, where the programs are found."""
import os
import pathlib
import shutil

PACKAGE = pathlib.Path(__file__).resolve().parent
IN_CHECKOUT = (PACKAGE.parents[2] / "CMakeLists.txt").exists()
BY_PIP = not IN_CHECKOUT and not (PACKAGE / "VERSION").exists()  # `cmake --install` writes VERSION


def build():
    """Folder whose bin/ contains the programs: that of COUPLET_BIN, build/ of a checkout, the prefix, or that of the
    `coupler` on PATH."""
    if "COUPLET_BIN" in os.environ:
        return pathlib.Path(os.environ["COUPLET_BIN"]).absolute().parent
    if BY_PIP and (found := shutil.which("coupler")):
        return pathlib.Path(found).resolve().parents[1]
    return PACKAGE.parents[2] / "build" if IN_CHECKOUT else PACKAGE.parents[3]


def root():
    """Folder with configs/ and docs/: the checkout, or share/couplet of the prefix."""
    if BY_PIP:
        places = (build() / "share/couplet", build().parent)
        return next((place for place in places if (place / "configs").is_dir()), places[0])
    return PACKAGE.parents[2] if IN_CHECKOUT else PACKAGE.parents[1]


ROOT = root()


def command(name="couplet"):
    """Path of the command `couplet`, or of `couplet-exec`."""
    return (ROOT / "scripts" if IN_CHECKOUT else PACKAGE.parents[3] / "bin") / name
