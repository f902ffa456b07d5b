#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the sources: who may include whom and the namespace of each folder (docs/architecture.md), the line budget (budget.csv), which folder sees
which third-party headers, one reader for each foreign format, one writer in Python, an SPDX line in every source, output of runs, cited papers, links, and the format where
clang-format is installed.
Usage: check_sources.py PROJECT_ROOT [--lower-budget]     the option writes the lines of today to budget.csv where they are fewer"""
import ast
import csv
import pathlib
import re
import shutil
import subprocess
import sys

BUDGET = pathlib.Path(__file__).with_name("budget.csv")
PROGRAMS = ["solid_solver", "fluid_solver", "mesh_mover", "thermocline", "plate_modal", "coupler"]
# Below which folders of common each folder of common stands.
ALLOWED = {
    "base": [],
    "log": ["base"],
    "diagnostics": ["log", "base"],
    "config": ["base"],
    "csv": ["base"],
    "parallel": ["base"],
    "linalg": ["parallel", "log", "base"],
    "mesh": ["parallel", "config", "csv", "log", "base"],
    "fv": ["mesh", "linalg", "parallel", "config", "csv", "log", "base"],
    "elasticity": ["fv", "mesh", "linalg", "parallel", "config", "csv", "log", "base"],
    "time": ["parallel", "config", "base"],
    "contact": ["fv", "config", "base"],
    "io": ["diagnostics", "fv", "mesh", "linalg", "parallel", "config", "csv", "log", "base"],
    "modes": ["io", "mesh", "linalg", "parallel", "log", "base"],
    "coupling": ["io", "mesh", "parallel", "config", "log", "base"],
    "app": ["diagnostics", "coupling", "time", "io", "fv", "mesh", "linalg", "parallel", "config", "csv", "log", "base"],
}
NOT_FOR = {"coupler": ["mesh", "fv"]}
# Third-party headers by pattern, and the folders that may include them.
THIRD_PARTY = {
    r"petsc|slepc": ["common/linalg", "common/modes"],
    r"hdf5|H5": ["common/io"],
    r"yaml-cpp/": ["common/config"],
    r"CLI/": ["common/app"],
    r"muParser": ["common/fv"],
    r"nanoflann": ["common/base"],
    r"spdlog/": ["common/log"],
    r"zlib": ["common/csv"],
    r"pugixml": ["client"],
}
# One reader of each foreign format: what only its own files may write, and which these are.
DOORS = {
    "HDF5 is read and written by common/io/hdf5*, everything else asks hdf5::Reader":
        (r"\bH5[A-Z]{1,2}[a-z]\w*\s*\(|\b(?:hid|herr|hsize)_t\b",
         r"common/io/hdf5\w*\.[ch]pp"),
    "messages between programs are unpacked by common/coupling/messages (and by the clients, which share nothing)":
        (r"\bUnpacker\b|0x434f'?4d4d|0x5245'?504c", r"common/coupling/messages\.[ch]pp|client/(?:wire\.[ch]pp|python/couplet/participant\.py)"),
    "messages are received by common/coupling/wait.cpp (ghosts by common/parallel, a client's by its wire)":
        (r"\bMPI_(?:I|M|Im)?[Rr]ecv\b", r"common/coupling/wait\.cpp|common/parallel/\w+\.cpp|client/wire\.[ch]pp"),
    "handshake and roll call are read by common/app/case/roll_call.cpp (and by the clients)":
        (r"0x434f'?5550'?4c45'?54", r"common/app/case/roll_call\.cpp|client/(?:wire\.[ch]pp|python/couplet/participant\.py)"),
}
# Functions that open a file to read, take lines apart, decompress, or make a number of a text.
READING = (r"\bstd::(?:ifstream|fstream|filebuf|basic_ifstream|from_chars|getline|sto(?:d|f|ld|i|l|ll|ul|ull)|strto\w+|ato(?:f|i|l|ll)|sscanf|fopen)\b"
           r"|\bgetline\(|\bgz(?:open|dopen|read|gets)\w*\(|\binflate\w*\(|\bf(?:open|dopen|scanf|gets)\(|\bv?sscanf\(|\bato(?:f|i|l|ll)\("
           r"|\bstrto(?:d|f|ld|l|ul|ll|ull|imax|umax)\(|\bmmap\(|\bO_RD(?:ONLY|WR)\b|\bfrom_chars\(")
DOORS["text data are read by common/csv (LineReader, CsvReader, number_of), and no physics reads files"] = (
    READING, r"(?:client|common/(?:app|base|config|coupling|csv|diagnostics|io|log|mesh|parallel))/.*")
# Methods and functions of Python that write a file whose name they are given; those of shutil, too.
WRITING = {"write_text", "write_bytes", "savefig", "symlink", "symlink_to", "hardlink_to", "touch", "tofile", "save", "savetxt", "savez", "imsave"}
COPYING = {"copy", "copy2", "copyfile", "copytree", "move"}
SOURCES = ("*.cpp", "*.hpp")
SCRIPTS = ("*.py", "*.geo", "CMakeLists.txt", "case.yaml")


def folder_of(path):
    """"common/mesh" or "coupler"."""
    return "/".join(path.parts[:2]) if path.parts[0] == "common" else path.parts[0]


def wrong_include(path, included):
    """What is wrong with one #include of a file, or nothing."""
    here = folder_of(path)
    if here in ("tests", "benchmarks"):
        return None
    target = pathlib.PurePosixPath(included)
    top = target.parts[0]
    if here == "client" and len(target.parts) > 1 and top in ("common", "tests", *PROGRAMS):
        return "the client knows the protocol alone"
    if top == "tests":
        return "production code includes test code"
    if top in PROGRAMS and top != here:
        return f"{here} may not include {top}"
    if top == "common" and len(target.parts) > 2:
        layer = target.parts[1]
        if here.startswith("common/"):
            own = here.split("/")[1]
            if layer != own and layer not in ALLOWED.get(own, []):
                return f"common/{own} stands below common/{layer} or beside it"
        elif layer in NOT_FOR.get(here, []):
            return f"{here} may not know common/{layer}"
    for pattern, allowed in THIRD_PARTY.items():
        if re.match(pattern, included) and here not in allowed:
            return f"only {', '.join(allowed)} may include it"
    return None


def second_readers(path, text):
    """Places where a program reads a foreign format that has its reader elsewhere. Tests and scripts may look at anything."""
    if path.parts[0] in ("tests", "benchmarks", "scripts", "configs"):
        return []
    found = []
    for rule, (pattern, own) in DOORS.items():
        if re.fullmatch(own, str(path)):
            continue
        for number, line in enumerate(text.splitlines(), 1):
            if re.search(pattern, re.sub(r"//.*", "", line), re.I if "0x" in pattern else 0):
                found.append(f"{path}:{number}: a second reader of a foreign format: {rule}")
    return found


def python_writers(path, text):
    """Calls of the package `couplet` that write a file on their own and not the new file of `with files.part(...) as made`, so that they might write through a link."""
    if path.parts[:3] != ("client", "python", "couplet") or path.name == "files.py":
        return []
    tree, found = ast.parse(text), []
    made = {item.optional_vars.id for node in ast.walk(tree) if isinstance(node, ast.With) for item in node.items
            if item.optional_vars and ast.unparse(item.context_expr).startswith("files.part(")}
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        owner, _, name = ast.unparse(call.func).rpartition(".")
        place = ast.unparse(call.args[0]) if call.args else ""
        modes = [a.value for a in (*call.args, *(k.value for k in call.keywords if k.arg == "mode")) if isinstance(a, ast.Constant) and isinstance(a.value, str)]
        opens = name in ("open", "File") and (owner == "os" or any(re.fullmatch("[rbt]*[wax+][bt+]*", mode) for mode in modes))
        if (opens or name in WRITING or owner == "shutil" and name in COPYING) and place not in made | {"os.devnull"}:
            found.append(f"{path}:{call.lineno}: {name}() writes a file on its own: couplet/files.py does so without following links")
    return found


def namespaces(document):
    """{folder or header: namespace} of the table in docs/architecture.md."""
    return dict(re.findall(r"^\| `([\w/.]+)` \| `(couplet[\w:]*)` \|", document, re.M))


def check_namespaces(path, text, table):
    """Blocks of a header in another namespace than that of its folder. A namespace within it is allowed, and so is a forward declaration."""
    fits = [folder for folder in table if path == folder or path.startswith(folder + "/")]
    if not path.endswith(".hpp") or not fits:
        return []
    want, found = table[max(fits, key=len)], []
    text = re.sub(r"//[^\n]*", "", text)
    for block in re.finditer(r"^namespace\s+(couplet[\w:]*)\s*\{", text, re.M):
        end, depth = block.end(), 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        own = block[1] == want or block[1].startswith(want + "::")
        declared = re.fullmatch(r"\s*(?:(?:template\s*<[^;{}]*>\s*)?(?:class|struct|enum class)\s+\w+(?:\s*:\s*[\w:]+)?;\s*)+", text[block.end():end - 1])
        if not own and not declared:
            found.append(f"{path}:{text.count(chr(10), 0, block.start()) + 1}: namespace {block[1]}: docs/architecture.md wants {want}")
    return found


def lines_of(sources):
    """Lines of C++ per top-level folder. `sources`: (path, text)."""
    lines = {}
    for path, text in sources:
        if path.suffix in (".cpp", ".hpp"):
            lines[path.parts[0]] = lines.get(path.parts[0], 0) + len(text.splitlines())
    return lines


def check_budget(lines, budget):
    """The budget falls, except for what users get: a commit that raises it says for what."""
    return [f"{folder}: {n} lines of C++, tests/architecture/budget.csv allows {budget.get(folder, 0)}: make something else simpler, or raise the "
            "budget by what users get, and say so" for folder, n in sorted(lines.items()) if n > budget.get(folder, 0)]


def check_text(path, text, table):
    """All that is wrong in one file; `path` is relative to the project, `table` has the namespaces."""
    trouble = []
    lines = text.splitlines()
    if not any("SPDX-License-Identifier: Apache-2.0" in line for line in lines[:3]):
        trouble.append(f"{path}: no SPDX line at the top")
    if path.suffix in (".cpp", ".hpp", ".py"):
        trouble += second_readers(path, text) + (python_writers(path, text) if path.suffix == ".py" else [])
    if path.suffix in (".cpp", ".hpp"):
        trouble += check_namespaces(path.as_posix(), text, table)
        for number, line in enumerate(lines, 1):
            match = re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line)
            reason = match and wrong_include(path, match.group(1))
            if reason:
                trouble.append(f"{path}:{number}: #include {match.group(1)}: {reason}")
    return trouble


def project_files(root):
    tops = ["common", "tests", "scripts", "configs", "benchmarks", "client", *PROGRAMS]
    files = [root / "CMakeLists.txt"]
    for top in tops:
        for pattern in SOURCES + SCRIPTS:
            files += (root / top).rglob(pattern)
    files += [f for f in (root / "scripts").iterdir() if f.is_file()]
    return sorted({f for f in files if "__pycache__" not in f.parts and "/out/" not in str(f)})


def check_format(root, files):
    """Files that clang-format would change; the style is that of version 14."""
    program = shutil.which("clang-format-14") or shutil.which("clang-format")
    if not program or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
        print("clang-format 14 is not installed: the format was not checked")
        return []
    sources = [f for f in files if f.suffix in (".cpp", ".hpp")]
    result = subprocess.run([program, "--dry-run", "--style=file", *map(str, sources)], cwd=root, capture_output=True,
                            text=True)
    places = re.findall(r"^(\S+?):\d+:\d+: warning", result.stderr, flags=re.M)
    return [f"{pathlib.Path(place).relative_to(root)}: not formatted, run clang-format -i" for place in
            dict.fromkeys(places)]


def check_references(bib, texts):
    """`bib` must hold each paper once and all that `texts`, pairs of name and text, cite by name and year in brackets; no
    text may be left half merged."""
    keys = re.findall(r"^@\w+\{([\w-]+),$", bib, flags=re.M)
    trouble = [f"docs/references.bib: {key} stands there twice" for key in sorted({k for k in keys if keys.count(k) > 1})]
    if bib.count("{") != bib.count("}") or len(keys) != bib.count("@"):
        trouble.append("docs/references.bib: braces or entries are not whole")
    for name, text in [*texts, ("docs/references.bib", bib)]:
        if re.search(r"^(<{7} |={7}$|>{7} )", text, flags=re.M):
            trouble.append(f"{name}: a conflict of a merge is left in it")
        trouble += [f"{name}: [{key}] is not in docs/references.bib" for key in
                    dict.fromkeys(re.findall(r"\[([a-z]+(?:1[89]|20)\d\d)\]", text)) if key not in keys]
    return trouble


def check_links(texts, exists):
    """Links within the project lead somewhere. `texts`: (path, text) of Markdown files; `exists`: path -> bool."""
    trouble = []
    for path, text in texts:
        prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
        for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", prose):
            if "://" not in link and not exists(path.parent / link):
                trouble.append(f"{path}: there is no {link}")
    return trouble


def check_monitors(texts, formats):
    """Every .csv file that a program writes is explained in docs/formats.md. `texts`: (path, text) of sources."""
    named = set(re.findall(r"[/`]([a-z-]+\.csv)`", formats))
    return [f"{path}: {name} is not listed in docs/formats.md" for path, text in texts if path.suffix == ".cpp" and path.parts[0] not in ("tests", "client")
            for name in dict.fromkeys(re.findall(r'"([a-z-]+\.csv)"', text)) if name not in named]


def committed_output(paths):
    """What runs write and nobody commits."""
    return [f"{path}: output of a run" for path in paths if re.search(r"(^|/)out(-[^/]*)?/|\.(log|lock|xdmf)$|\.cache\.msh$|^[^/]+\.(csv|png|npy)$", path)]


def main(root, lower=False):
    files = project_files(root)
    sources = [(f.relative_to(root), f.read_text()) for f in files]
    budget = {row["folder"]: int(row["lines"]) for row in csv.DictReader(BUDGET.open())}
    if lower:
        budget = {folder: min(n, lines_of(sources).get(folder, 0)) for folder, n in budget.items()}
        BUDGET.write_text("folder,lines\n" + "".join(f"{folder},{n}\n" for folder, n in budget.items()))
    table = namespaces((root / "docs/architecture.md").read_text())
    trouble = check_format(root, files) + check_budget(lines_of(sources), budget)
    for path, text in sources:
        trouble += check_text(path, text, table)
    paths = [f.relative_to(root) for f in root.rglob("*.md")]
    notes = [(f, (root / f).read_text()) for f in paths if not any(p.startswith((".", "build")) for p in f.parts)]
    trouble += [f"{f}: its first line is no heading: '# ...' (was it formatted as a source?)" for f, text in notes if f.name == "README.md" and not re.match("(<!--.*?-->\\s*)?# ", text, re.S)]
    trouble += check_references((root / "docs/references.bib").read_text(), sources + notes)
    trouble += check_monitors(sources, (root / "docs/formats.md").read_text())
    tracked = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=False).stdout  # nothing in a tarball
    trouble += committed_output(tracked.splitlines())
    trouble += check_links(notes, lambda link: (root / link).exists())
    print("\n".join(trouble) or f"{len(files)} files: in order")
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), "--lower-budget" in sys.argv[2:]))
