# SPDX-License-Identifier: Apache-2.0
"""Lists the example cases: name, programs, and what each shows. `couplet new` copies one."""
import textwrap

from couplet.runs import gallery
from couplet.runs.case import expect


def declare(parser):
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="lists only cases whose name, text or programs contain all of these words",
    )
    parser.add_argument("-l", "--long", action="store_true", help="adds a description of each case")


def run(arguments):
    words = [w.lower() for w in arguments.words]
    found = [
        e
        for e in gallery.entries()
        if all(w in f"{e.name} {e.title} {e.about} {' '.join(e.programs)}".lower() for w in words)
    ]
    expect(found, "no case matches " + " and ".join(f'"{word}"' for word in arguments.words))
    for e in found:
        print(f"{e.name:28} {', '.join(e.programs)}")
        if arguments.long:
            print(textwrap.fill(e.about, 96, initial_indent="    ", subsequent_indent="    "))
    return 0
