#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The check of language must find each avoided word of docs/glossary.md, else it proves nothing, and must leave honest English alone."""
import pathlib
import sys

from check_language import check, is_document, is_message, table

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORDS, ALLOWED = table((ROOT / "docs/glossary.md").read_text())

# One text per avoided expression at least; ~ is the end of a line.
FIRES = """The log tells it.|It is told at the end.|Telling the user.|The run says so.|The number said above.|Programs say which file they read.|twins at the interface|a twin of it
A pressure of 3 Pa is none.|A dear solve.|a dearer method|the dearest one|the scheme bears long steps|The data bears out the claim.|where each scheme holds|where it holds
The scheme holds at 5.|a longer step holds|holds and where it stops|The books are kept.|the books close|by the turn of the rod|one value a place|one place of the vertex|that of each place
size or place|is asked for by a key|if asked for|effects left out|what it leaves out|leaving it out was sound|the run doubts it|doubtful above 20 %|nothing to speak of|The run goes on.|to go on from
it went on|it has gone on|found no way on|what a step leaves|a case's own mesh|the swing of the pressure|it swings|swinging modes|it swung|without a word|it says a word|drawn through a pipe
carried by the flow|points carried along|the thesis's gradient|7 passes a step|a row a run|once a step|8 cells a side|16 bytes a cell|bars in space|In the plane it follows|a program of somebody else
somebody's case|the guest speaks|two guests|in the midst of a run|nothing stands in the way|stops to matter|mends the case|true by a hair|as from of old|a run that broke off|a line that breaks off
the same all the same|so many at a time|bear it|telling it
a longer step~holds|and the run goes~on|in midst of it|it has broken off""".replace("\n", "|").split("|")
SILENT = """It reports what happened.|tell apart two cells|that is to say|there is none|bear in mind that|a load-bearing wall|the bearing load|it holds 3 values|in turn|one step at a time
in space and time|second order in space|a field linear in space|loads in the plane of the plate|no doubt|a cell of the mesh|a face and a cell|passes through a step|in place of heat|takes place|a handbook of flows
the load carried by the wall|the `says` key|[text](says/told.md)|a step of 1 ms|half a cell|within a step|if a run fails|heat swing|per step|hours a day|what remains|a swinging-door|a 3 a cell""".replace("\n", "|").split("|")

failed = 0
for expected, texts in ((True, FIRES), (False, SILENT)):
    for text in texts:
        text = text.replace("~", "\n")
        literal = text.replace("\n", ' "\n    "')
        for name, shown in (("docs/a.md", f"# A\n\n{text}\n"), ("a/b.cpp", f'f("{literal}");\n'), ("a/b.py", f'f("{literal}")\n')):
            found = check(name, shown, WORDS, ALLOWED)
            if bool(found) != expected:
                print(f"{name}: {text!r}: wanted {'a finding' if expected else 'nothing'}, found {found}")
                failed += 1
for word, _ in WORDS:
    if not any(word.search(text.replace("~", "\n")) for text in FIRES):
        print(f"no sample for {word.pattern}")
        failed += 1

WHERE = {  # only prose and literals count, and the line is the word's
    ("a.md", "x\n\n```\nit says\n```\n`says` [b](says.md)\n\n    it says\n\nit says\n"): [10],
    ("a.md", "| it says |\n<!-- it says -->\n"): [1],
    ("a.cpp", "// it says\nint says = 1;  /* it says */\nf(\"a\",\n  \"it\"\n  \" says\");\n"): [5],
    ("a.cpp", "f(R\"(one\ntwo it says)\", '\"', \"x \\\" it says\");\n"): [2, 2],
    ("a.cpp", "#include \"it says.hpp\"\nf(\"it\", \" says\");\n"): [2],
    ("a.py", "says = 1  # it says\nf(r\"it says\", f\"x {says} y\", 'it says')\n"): [2],
    ("a.yaml", "# it says\nrows:\n  'it holds 3, it says': {long: [x, it says]}\nnote: |-\n  a\n  it says `it says`\n"): [3, 6],
    ("a.py", "\"\"\"One.\n\nIt says.\"\"\"\nf(f\"it {a} says\")\n"): [3, 4],
}
for (name, text), lines in WHERE.items():
    found = sorted({int(line.split(":")[1]) for line in check(name, text, WORDS, ALLOWED)})
    if found != sorted(set(lines)):
        print(f"{name}: {text!r}: wanted lines {lines}, found {found}")
        failed += 1
ASKED = {"README.md": True, "docs/theory.md": True, "docs/effects.md": False, "docs/validation/fluid.md": False, "docs/validation/studies/README.md": True, "docs/glossary.md": False, "configs/a/README.md": True}
failed += sum(is_document(path) != wanted for path, wanted in ASKED.items())
SEARCHED = {"common/mesh/mesh.cpp": True, "tests/unit/mesh/a.cpp": False, "client/python/couplet/command/run.py": True, "scripts/docs": True, "scripts/environment": False, "scripts/validation/tables/fluid.yaml": True, "configs/cook/case.yaml": False, "client/couplet.h": False}
failed += sum(is_message(path, ROOT) != wanted for path, wanted in SEARCHED.items())
print(f"{len(FIRES) + len(SILENT) + len(WHERE) + len(ASKED) + len(SEARCHED)} samples of {len(WORDS)} expressions, {failed} judged wrongly")
sys.exit(1 if failed else 0)
