#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The source check must notice each kind of violation, else it proves nothing."""
import pathlib
import re
import sys

from check_sources import check_findings, check_links, check_monitors, check_references, check_text, committed_output
from floors import FLOORS, MOST_FILES, UPWARDS, crowded
from lengths import LARGE_CLASSES, LONG_FILES, MOST_FOR_A_REASON
from namespaces import EVERYBODYS, NAMESPACES
from readers import READERS, check_readers

HEAD = "// SPDX-License-Identifier: Apache-2.0\n"


def class_of(n):
    """A class with n member functions, and with what looks like one and is none."""
    kinds = ["  A(int a) : a_(a), b_{f(a)} {}\n", "  bool operator==(const A& b) const = default;\n", "  ~A();\n",
             "  int f(int x = g(1)) const { return f(x) + (x); }\n", "  template <class T> T h(std::span<const T> x);\n",
             "  virtual std::vector<std::pair<int, int>> k(const B& b) = 0;\n"]
    none = ["  // int f(int x);\n", "  using F = std::function<void(int)>;\n", "  std::function<int(double)> g_;\n",
            "  double b_ = f(2) + g(3), c_{f(4)};\n", "  friend int f(A& a);\n", "  const char* t_ = \"int f(int x);\";\n",
            "  struct D { int f(); int g(); };\n", "  enum class E { a = sizeof(int), b };\n"]
    return "class A final : public B {\n public:\n" + "".join(kinds[i % len(kinds)] for i in range(n)) + "".join(none) + "};\n"


def function_of(n):
    """A function of n lines, within a namespace."""
    return "namespace {\nint f(int x) {\n" + "  if (x > 0) { --x; }\n" * (n - 3) + "  return x;\n}\n}\n"


WRONG = {
    ("common/mesh/a.cpp", HEAD + '#include "common/io/series.hpp"\n'): "common/mesh stands below common/io",
    ("common/log/a.cpp", HEAD + '#include "common/config/section.hpp"\n'): "common/log stands below common/config",
    ("coupler/a.cpp", HEAD + '#include "common/mesh/mesh.hpp"\n'): "coupler may not know common/mesh",
    ("solid_solver/a.cpp", HEAD + '#include "fluid_solver/step/fluid.hpp"\n'): "solid_solver may not include fluid_solver",
    ("fluid_solver/a.cpp", HEAD + "#include <petscksp.h>\n"): "only common/linalg",
    ("fluid_solver/state/a.hpp", HEAD + '#include "fluid_solver/step/fluid.hpp"\n'): "fluid_solver/step stands above state",
    ("common/mesh/mesh.hpp", HEAD + '#include "common/mesh/gmsh/gmsh.hpp"\n'): "common/mesh/gmsh stands above .",
    ("coupler/cellar/a.hpp", HEAD + '#include "coupler/mapping/links.hpp"\n'): "coupler/cellar has no place",
    ("common/mesh/a.cpp", HEAD + "#include <hdf5.h>\n"): "only common/io",
    ("common/app/a.cpp", HEAD + "#include <yaml-cpp/yaml.h>\n"): "only common/config",
    ("coupler/a.cpp", HEAD + '#include "tests/support/a.hpp"\n'): "production code includes test code",
    ("coupler/b.cpp", HEAD + "#include <nanoflann.hpp>\n"): "only common/base may include it",
    ("common/base/a.cpp", "int a;\n"): "no SPDX line",
    ("common/io/checkpoint.cpp", HEAD + "const auto id = H5Fopen(name, 0, 0);\n"): "a second reader",
    ("common/modes/a.cpp", HEAD + "void f(hid_t id);\n"): "a second reader",
    ("coupler/d.cpp", HEAD + "Unpacker in(bytes, 0);\n"): "a second reader",
    ("coupler/e.cpp", HEAD + "constexpr long mark = 0x434F4D4D;\n"): "a second reader",
    ("fluid_solver/e.cpp", HEAD + "MPI_Recv(at, n, MPI_BYTE, 0, 0, comm, MPI_STATUS_IGNORE);\n"): "a second reader",
    ("common/base/a.cpp", HEAD + "\n" * 300): "301 lines",
    ("tests/unit/a.cpp", HEAD + "\n" * 500): "501 lines",
    ("common/base/a.hpp", HEAD + class_of(26)): "A has 26 member functions",
    ("plate_modal/structure.hpp", HEAD + class_of(41).replace("class A ", "class Structure ")): "Structure has 41 member functions",
    ("coupler/f.cpp", HEAD + function_of(61)): "a function of 61 lines",
    ("coupler/a.hpp", HEAD + "namespace couplet {\nint a();\n}  // namespace couplet\n"): "stands in couplet::coupler",
    ("coupler/mapping/a.hpp", HEAD + "namespace couplet { struct A {}; }\n"): "stands in couplet::coupler",
    ("thermocline/bed/a.hpp", HEAD + "namespace couplet::fluid\n{\nclass A;\nint f(A&);\n}\n"): "stands in couplet::thermocline",
    ("common/csv/a.hpp", HEAD + "namespace couplet::csvs {\nclass A;\nint a();\n}\n"): "stands in couplet::csv",
}
RIGHT = [
    ("common/io/hdf5_reader.cpp", HEAD + "const Handle id(H5Fopen(name, 0, 0), H5Fclose);  // hid_t\n"),
    ("coupler/a.cpp", HEAD + "// as H5Fopen( does\nint a;\n"),
    ("tests/unit/io/a.cpp", HEAD + "const auto id = H5Fopen(name, 0, 0);\n"),
    ("common/io/a.cpp", HEAD + '#include <hdf5.h>\n#include "common/mesh/mesh.hpp"\n'),
    ("fluid_solver/a.cpp", HEAD + '#include "fluid_solver/step/fluid.hpp"\n#include "common/fv/expression.hpp"\n'),
    ("common/base/a.cpp", HEAD + "#include <nanoflann.hpp>\n"),
    ("coupler/judge/a.cpp", HEAD + '#include "coupler/judge/b.hpp"\n#include "coupler/mapping/links.hpp"\n'),
    ("coupler/a.hpp", HEAD + "namespace couplet::fluid {\nclass A;\ntemplate <int D>\nstruct B;\n}\nnamespace couplet::coupler {\nint f(A&);\n}\n"),
    ("common/csv/a.hpp", HEAD + "namespace couplet::csv::detail {\nint f();\n}\n"),
    ("coupler/a.cpp", HEAD + "namespace couplet {\nint f();\n}\n"),
    ("tests/unit/a.hpp", HEAD + "namespace couplet {\nint f();\n}\n"),
    ("common/base/types.hpp", HEAD + "namespace couplet {\nusing Index = int;\n}\n"),
    ("coupler/f.cpp", HEAD + function_of(60)),
    ("tests/unit/a.cpp", HEAD + function_of(61) + "\n" * 400),
    ("plate_modal/structure.hpp", HEAD + class_of(40).replace("class A ", "class Structure ")),
    ("common/base/a.hpp", HEAD + class_of(25)),
    ("common/base/a.hpp", HEAD + class_of(25).replace("class A", "struct B {};\nstruct A")),
]

OUTPUT = ["body.csv", "configs/a/a.0f.vm.7.log", "configs/a/out/run.json", "configs/a/out-modal/a.h5", "configs/a/.checkpoints.lock", "configs/a/m.cache.msh"]
NO_OUTPUT = ["coupler/output/monitor.cpp", "docs/output.md", "configs/a/layout/a.geo", "common/log/log.cpp"]

failed = int(len(committed_output(OUTPUT)) != len(OUTPUT) or committed_output(NO_OUTPUT) != [])
for (path, text), reason in WRONG.items():
    found = check_text(pathlib.PurePosixPath(path), text)
    if len(found) != 1 or reason not in found[0]:
        print(f"{path}: wanted '{reason}', found {found}")
        failed += 1
for path, text in RIGHT:
    found = check_text(pathlib.PurePosixPath(path), text)
    if found:
        print(f"{path}: nothing is wrong, found {found}")
        failed += 1
for n, folder, wanted in ((MOST_FILES, "coupler/mapping", 0), (MOST_FILES + 1, "coupler/mapping", 1), (99, "tests/unit/io", 0)):
    found = crowded([pathlib.PurePosixPath(f"{folder}/f{i}.{'ch'[i % 2]}pp") for i in range(n)])
    if len(found) != wanted:
        print(f"{n} files in {folder}: wanted {wanted}, found {found}")
        failed += 1
ROOT = pathlib.Path(__file__).resolve().parents[2]
for home, floors in FLOORS.items():
    there = {f.parent.relative_to(ROOT / home).as_posix() for f in (ROOT / home).rglob("*.cpp")}
    if there != set(floors):
        print(f"{home}: the floors are not its sub-folders: {sorted(there ^ set(floors))}")
        failed += 1
for place, included in UPWARDS:
    if f'"{included}"' not in (ROOT / place).read_text():
        print(f"floors.py: {place} does not include {included} any more")
        failed += 1
for place, reason in EVERYBODYS.items():
    if not re.search(r"^namespace couplet \{", (ROOT / place).read_text(), re.M) or len(reason) < 20:
        print(f"namespaces.py: {place} needs no exception, or has no reason")
        failed += 1
rows = dict(re.findall(r"^\| `([\w/.]+)` \| `(couplet[\w:]*)` \|", (ROOT / "docs/architecture.md").read_text(), re.M))
if rows != {**NAMESPACES, **{place: "couplet" for place in EVERYBODYS}}:
    print(f"namespaces.py and docs/architecture.md differ: {sorted(set(rows.items()) ^ set(NAMESPACES.items()))}")
    failed += 1
BIB = "@article{stone1968,\n  year = {1968}\n}\n"
CITES = "see [sto" + "ne1968]"
REFERENCES = {
    (BIB, CITES): None,
    (BIB + BIB, CITES): "twice",
    (BIB[:-2], CITES): "not whole",
    (BIB.replace("1968,", "1969,"), CITES): "[sto" + "ne1968] is not in",
    (BIB, "=" * 7 + "\n"): "conflict",
    (BIB + "<" * 7 + " HEAD\n", ""): "conflict",
}
for (bib, text), reason in REFERENCES.items():
    found = check_references(bib, [("a.md", text)])
    if len(found) != (reason is not None) or reason and reason not in found[0]:
        print(f"references: wanted '{reason}', found {found}")
        failed += 1
LINKS = {"[a](b.md)": 0, "![a](c.png) and [d](https://e.org/f)": 1, "[g](b.md#h) [i](#j)": 0}
for text, broken in LINKS.items():
    found = check_links([(pathlib.PurePosixPath("docs/a.md"), text)], lambda link: link.name == "b.md")
    if len(found) != broken:
        print(f"links: {text}: {broken} lead nowhere, found {found}")
        failed += 1
MONITORS = {"| `fluid/forces.csv` | forces |": 0, "| `fluid/gaps.csv`, `fluid/forces.csv` |": 0, "forces.csv |": 1}
for formats, missing in MONITORS.items():
    found = check_monitors([(pathlib.PurePosixPath("fluid_solver/output/output.cpp"), 'open("forces.csv")')], formats)
    if len(found) != missing:
        print(f"monitors: {formats}: {missing} missing, found {found}")
        failed += 1
SECOND_READERS = {"std::ifstream in(file);": 1, "double v = std::stod(text);": 1, "while (std::getline(in, line))": 1, "gzopen(name, mode)": 1,
                  "const auto r = std::from_chars(a, b, v);": 1, "FILE* f = fopen(name, \"r\");": 1, "sscanf(text, format, &v);": 1,
                  "// std::ifstream in a comment": 0, "csv::LineReader in(file, kind);": 0, "std::ofstream out(file);": 0, "int stop = reopen(1);": 0, "std::atomic<int> n;": 0, "double v = std::atof(text);": 1}
for text, wrong in SECOND_READERS.items():
    for path, counts in (("fluid_solver/a.cpp", 1), ("tests/unit/a.cpp", 0), ("common/csv/cells.cpp", 0)):
        found, _ = check_readers([(pathlib.PurePosixPath(path), HEAD + text + "\n")])
        if len(found) != wrong * counts:
            print(f"readers: {path}: {text}: {wrong * counts} wrong, found {found}")
            failed += 1
if len(LARGE_CLASSES) > 17 or len(LONG_FILES) > 1 or MOST_FOR_A_REASON > 40 or not all(len(reason) > 20 for reason in (*LARGE_CLASSES.values(), *LONG_FILES.values())):
    print("lengths: no further exceptions, and each needs a reason")
    failed += 1
idle = check_readers([])[1]
if len(idle) != len(READERS) or not all(len(reason) > 8 for reason in READERS.values()):
    print(f"readers: each entry needs a reason and a reader, found {idle}")
    failed += 1
IDS, TABLE, CARD = '    FindingId{answer, "heat-swing", "it oscillates"},\n', "## Ids\n| `heat-swing` | the answer | it oscillates |\n", 'SolidCard{"heat swing", x, judge_heat}, SolidCard{"gravity", x}'
FINDINGS = {(IDS, TABLE, CARD): 0, (IDS, "## Ids\n", CARD): 1, ("", TABLE, ""): 1, (IDS, TABLE.replace("the answer", "a neglected effect"), ""): 2,
            (IDS, TABLE, CARD.replace("gravity", "heat").replace('"heat", x', '"heat", judge_it')): 1}
for (ids, table, card), count in FINDINGS.items():
    found = check_findings(ids, table, [card])
    if len(found) != count:
        print(f"findings: {count} wanted, found {found}")
        failed += 1
print(f"{len(SECOND_READERS) + len(FINDINGS) + len(WRONG) + len(RIGHT) + len(REFERENCES) + len(LINKS) + len(MONITORS)} samples, {failed} judged wrongly")
sys.exit(1 if failed else 0)
