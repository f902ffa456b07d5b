#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The source check must notice each kind of violation, else it proves nothing."""
import pathlib
import sys

from check_sources import check_budget, check_links, check_monitors, check_references, check_text, committed_output, lines_of, namespaces

HEAD = "// SPDX-License-Identifier: Apache-2.0\n"


TABLE = namespaces((pathlib.Path(__file__).resolve().parents[2] / "docs/architecture.md").read_text())
WRONG = {
    ("common/mesh/a.cpp", HEAD + '#include "common/io/series.hpp"\n'): "common/mesh stands below common/io",
    ("common/log/a.cpp", HEAD + '#include "common/config/section.hpp"\n'): "common/log stands below common/config",
    ("coupler/a.cpp", HEAD + '#include "common/mesh/mesh.hpp"\n'): "coupler may not know common/mesh",
    ("solid_solver/a.cpp", HEAD + '#include "fluid_solver/step/fluid.hpp"\n'): "solid_solver may not include fluid_solver",
    ("fluid_solver/a.cpp", HEAD + "#include <petscksp.h>\n"): "only common/linalg",
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
    ("coupler/a.hpp", HEAD + "namespace couplet {\nint a();\n}  // namespace couplet\n"): "wants couplet::coupler",
    ("coupler/mapping/a.hpp", HEAD + "namespace couplet { struct A {}; }\n"): "wants couplet::coupler",
    ("thermocline/bed/a.hpp", HEAD + "namespace couplet::fluid\n{\nclass A;\nint f(A&);\n}\n"): "wants couplet::thermocline",
    **{("client/python/couplet/a.py", "#" + HEAD[2:] + text): "couplet/files.py" for text in (
        "open(name, 'w')\n", "open(name, mode='ab')\n", "file.open('x')\n", "h5py.File(name, 'r+')\n", "pathlib.Path(a, b).write_text('')\n", "figure.savefig(name)\n",
        "shutil.copy(a, b)\n", "os.open(name, os.O_WRONLY)\n", "gzip.open(name, 'wt')\n", "with files.part(a, b) as made:\n    open(other, 'w')\n")},
    ("common/csv/a.hpp", HEAD + "namespace couplet::csvs {\nclass A;\nint a();\n}\n"): "wants couplet::csv",
}
RIGHT = [
    ("common/io/hdf5_reader.cpp", HEAD + "const Handle id(H5Fopen(name, 0, 0), H5Fclose);  // hid_t\n"),
    ("coupler/a.cpp", HEAD + "// as H5Fopen( does\nint a;\n"),
    ("tests/unit/io/a.cpp", HEAD + "const auto id = H5Fopen(name, 0, 0);\n"),
    ("client/python/couplet/a.py", "#" + HEAD[2:] + "with files.part(a, b) as made, open(made, 'w') as out:\n    figure.savefig(made)\nopen(name, 'rb')\nfiles.copy(a, b)\n"),
    ("tests/cli/a.py", "#" + HEAD[2:] + "open(name, 'w')\n"),
    ("common/io/a.cpp", HEAD + '#include <hdf5.h>\n#include "common/mesh/mesh.hpp"\n'),
    ("fluid_solver/a.cpp", HEAD + '#include "fluid_solver/step/fluid.hpp"\n#include "common/fv/expression.hpp"\n'),
    ("common/base/a.cpp", HEAD + "#include <nanoflann.hpp>\n"),
    ("coupler/mapping/a.cpp", HEAD + '#include "coupler/mapping/b.hpp"\n#include "coupler/mapping/links.hpp"\n'),
    ("coupler/a.hpp", HEAD + "namespace couplet::fluid {\nclass A;\ntemplate <int D>\nstruct B;\n}\nnamespace couplet::coupler {\nint f(A&);\n}\n"),
    ("common/csv/a.hpp", HEAD + "namespace couplet::csv::detail {\nint f();\n}\n"),
    ("coupler/a.cpp", HEAD + "namespace couplet {\nint f();\n}\n"),
    ("tests/unit/a.hpp", HEAD + "namespace couplet {\nint f();\n}\n"),
    ("common/base/types.hpp", HEAD + "namespace couplet {\nusing Index = int;\n}\n"),
]

OUTPUT = ["body.csv", "configs/a/a.0f.vm.7.log", "configs/a/out/run.json", "configs/a/out-modal/a.h5", "configs/a/.checkpoints.lock", "configs/a/m.cache.msh"]
NO_OUTPUT = ["coupler/output/monitor.cpp", "docs/output.md", "configs/a/layout/a.geo", "common/log/log.cpp"]

failed = int(len(committed_output(OUTPUT)) != len(OUTPUT) or committed_output(NO_OUTPUT) != [])
for (path, text), reason in WRONG.items():
    found = check_text(pathlib.PurePosixPath(path), text, TABLE)
    if len(found) != 1 or reason not in found[0]:
        print(f"{path}: wanted '{reason}', found {found}")
        failed += 1
for path, text in RIGHT:
    found = check_text(pathlib.PurePosixPath(path), text, TABLE)
    if found:
        print(f"{path}: nothing is wrong, found {found}")
        failed += 1
if TABLE.get("coupler") != "couplet::coupler" or len(TABLE) < 20:
    print("docs/architecture.md has no table of namespaces")
    failed += 1
LINES = lines_of([(pathlib.PurePosixPath(path), "a\nb\n") for path in ("coupler/a.cpp", "coupler/b/c.hpp", "common/a.py")])
for budget, count in (({"coupler": 4}, 0), ({"coupler": 3, "common": 9}, 1), ({}, 1)):
    if len(found := check_budget(LINES, budget)) != count:
        print(f"budget {budget}: {count} wanted, found {found}")
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
        found = check_text(pathlib.PurePosixPath(path), HEAD + text + "\n", TABLE)
        if len(found) != wrong * counts:
            print(f"readers: {path}: {text}: {wrong * counts} wrong, found {found}")
            failed += 1
print(f"{len(SECOND_READERS) + len(WRONG) + len(RIGHT) + len(REFERENCES) + len(LINKS) + len(MONITORS)} samples, {failed} judged wrongly")
sys.exit(1 if failed else 0)
