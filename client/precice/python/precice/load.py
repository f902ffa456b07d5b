# SPDX-License-Identifier: Apache-2.0
"""Finds and loads the C library."""
import atexit
import ctypes
import os
import pathlib
import sys


def library():
    """Library named by COUPLET_PRECICE_LIBRARY, else that of the prefix that contains this package (lib/couplet/precice)."""
    named = os.environ.get("COUPLET_PRECICE_LIBRARY")
    file = pathlib.Path(named) if named else pathlib.Path(__file__).resolve().parents[2] / "lib/libprecice.so.3"
    if not file.exists():
        raise ImportError(f"the library {file} does not exist; COUPLET_PRECICE_LIBRARY names another")
    # MPI loads components that need its global symbols.
    c = ctypes.CDLL(str(file), mode=ctypes.RTLD_GLOBAL)
    if not hasattr(c, "couplet_precice_keep_errors"):
        raise ImportError(f"{file} is not Couplet's library on preCICE's interface")
    c.couplet_precice_error.restype = ctypes.c_char_p
    c.couplet_precice_keep_errors(1)
    _end_with_the_program(c)
    return c


def _end_with_the_program(c):
    """Prints an uncaught exception before the library ends the job."""
    def flush():
        sys.stdout.flush()
        sys.stderr.flush()
    atexit.register(flush)
