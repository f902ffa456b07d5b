# SPDX-License-Identifier: Apache-2.0
"""The project's bars, a module a validation (scripts/validate). They use the package of client/python."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "client/python"))
