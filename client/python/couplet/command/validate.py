# SPDX-License-Identifier: Apache-2.0
"""Runs the acceptance tests of the project with the programs and tests of a checkout. Takes the options of
scripts/validate."""
import argparse
import os

from couplet import places
from couplet.runs.case import expect


def declare(parser):
    parser.add_argument(
        "words",
        nargs=argparse.REMAINDER,
        metavar="NAME ...",
        help="arguments of scripts/validate; without any, lists what can be measured",
    )


def run(arguments):
    script = places.ROOT / "scripts/validate"
    expect(places.IN_CHECKOUT and script.exists(), "acceptance tests are run in a checkout of the project")
    os.execv(script, [str(script), *(arguments.words or ["--help"])])
