# SPDX-License-Identifier: Apache-2.0
"""Finds and loads the C library."""
import atexit
import ctypes
import os
import pathlib
import sys


def library():
    """The one that COUPLET_PRECICE_LIBRARY names, else that of the prefix in which this package lies (lib/couplet/precice)."""
    named = os.environ.get("COUPLET_PRECICE_LIBRARY")
    file = pathlib.Path(named) if named else pathlib.Path(__file__).resolve().parents[2] / "lib/libprecice.so.3"
    if not file.exists():
        raise ImportError(f"the library {file} does not exist; COUPLET_PRECICE_LIBRARY names another")
    # MPI loads parts of itself that look for the rest of it among the global symbols.
    c = ctypes.CDLL(str(file), mode=ctypes.RTLD_GLOBAL)
    if not hasattr(c, "couplet_precice_keep_errors"):
        raise ImportError(f"{file} is not Couplet's library on preCICE's interface")
    c.couplet_precice_error.restype = ctypes.c_char_p
    c.couplet_precice_keep_errors(1)
    _end_with_the_program(c)
    return c


def _end_with_the_program(c):
    """An exception that nobody catches is printed before the library ends the job for it."""
    def flush():
        sys.stdout.flush()
        sys.stderr.flush()
    atexit.register(flush)
