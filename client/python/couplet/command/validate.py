# SPDX-License-Identifier: Apache-2.0
"""Measures the project's bars with the built programs and tests, in a checkout: scripts/validate, whose options it takes."""
import argparse
import os

from couplet import places
from couplet.runs.case import expect


def declare(parser):
    parser.add_argument("words", nargs=argparse.REMAINDER, metavar="NAME ...", help="as of scripts/validate; without any it lists them")


def run(arguments):
    script = places.ROOT / "scripts/validate"
    expect(places.IN_CHECKOUT and script.exists(), "bars are measured in a checkout of the project, where its tests are")
    os.execv(script, [str(script), *(arguments.words or ["--help"])])
