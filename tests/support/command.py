# SPDX-License-Identifier: Apache-2.0
"""The command `couplet` within the process of a test: what loads matplotlib once a call takes a second each time."""
import contextlib
import io
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
from couplet.command import main  # noqa: E402


def couplet(*words):
    """As subprocess.run(["couplet", ...]) answers."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = main(["couplet", *map(str, words)])
        except SystemExit as end:
            code = end.code
    return subprocess.CompletedProcess(words, code or 0, out.getvalue(), err.getvalue())
