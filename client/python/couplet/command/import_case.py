# SPDX-License-Identifier: Apache-2.0
"""Creates a case from a CalculiX or Abaqus deck, or from a preCICE configuration. A deck (.inp) provides the mesh,
materials, supports, loads and the first step of the case; everything that is left out is listed with its line
(docs/how-to/calculix-deck.md). A configuration (.xml) yields a job of programs that use preCICE's interface
(docs/precice.md). The programs still read the XML themselves. Differences are listed. If an element is not supported,
it is named with its line, and no case is written (exit code 2)."""
import pathlib

from couplet.runs.case import expect


def declare(parser):
    parser.add_argument(
        "configuration",
        type=pathlib.Path,
        metavar="FILE",
        help="a deck (.inp), or a preCICE configuration, such as precice-config.xml",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=pathlib.Path,
        metavar="YAML",
        help="case to write (default: next to the file, with the same name and the ending .yaml)",
    )
    parser.add_argument(
        "--units", choices=("si", "mm"), help="units of a deck: SI, or mm, N, tonne, s and MPa (default: si)"
    )
    parser.add_argument(
        "--check", action="store_true", help="lists differences and unsupported elements without writing a case"
    )
    parser.add_argument("--force", action="store_true", help="overwrites an existing case")


def run(arguments):
    if arguments.configuration.suffix.lower() == ".inp":
        from couplet.command import import_deck as chosen
    else:
        from couplet.command import import_precice as chosen

        expect(arguments.units is None, "--units: applies to decks (.inp) only")
    return chosen.run(arguments)
