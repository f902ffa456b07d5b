#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds the first table of docs/glossary.md: none of its avoided words in hand-written Markdown or in string literals of programs, client and scripts,
rows of tables among them.
Usage: check_language.py PROJECT_ROOT [--messages | --documents]      prints file:line, the word and what to write; exit 1 if there is any"""
import functools
import io
import pathlib
import re
import subprocess
import sys
import tokenize

import yaml

SOURCES = ("common/", "coupler/", "fluid_solver/", "solid_solver/", "mesh_mover/", "thermocline/", "plate_modal/", "client/", "scripts/", "configs/")
GENERATED = r"docs/(?:config|effects|command|stability)\.md|docs/validation/(?!studies/README).*"  # from literals, which are searched themselves


def table(text):
    """[(expression, what to write)] and the phrases allowed, of the table under '## Not, but'."""
    words, allowed = [], []
    for line in text.partition("## Not, but")[2].partition("\n## ")[0].splitlines():
        cells = [c.strip() for c in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) != 3 or not cells[0].startswith("`"):
            continue
        spans = [[s.replace("\\|", "|") for s in re.findall(r"`([^`]+)`", cell)] for cell in (cells[0], cells[2])]
        words += [(expression(s), cells[1]) for s in spans[0]]
        allowed += [expression(s) for s in spans[1]]
    return words, allowed


def expression(text):
    return re.compile(rf"(?<![\w'-])(?:{text.replace(' ', chr(92) + 's+')})(?![\w-])", re.I)


@functools.cache
def one_of(expressions):
    """Finds whether any of them is there: one pass in place of one for each."""
    return re.compile("|".join(e.pattern for e in expressions), re.I)


def blank(match):
    return re.sub(r"[^\n]", "\0", match.group())


def prose(text):
    """[(line, text)] of Markdown: all of it, with code, link targets and comments blanked."""
    for pattern in (r"^ *```.*?^ *```", r"<!--.*?-->"):
        text = re.sub(pattern, blank, text, flags=re.M | re.S)
    for pattern in (r"(?:(?<=\n\n)|(?<=\n\0))(?: {4}[^\n]*\n)+", r"`[^`]+`", r"\]\([^)]*\)", r"https?://\S+"):
        text = re.sub(pattern, blank, text)
    return [(1, text)]


def joined(literals, text):
    """[(line, text)] of string literals, given as (begin, end, content); neighbours with nothing but space between are one text."""
    chunks, last, line, at = [], None, 1, 0
    for begin, end, content in literals:
        line, at = line + text.count("\n", at, begin), begin
        if last is not None and not (between := text[last:begin]).strip():
            chunks[-1][1] += "\n" * between.count("\n") + content
        else:
            chunks.append([line, content])
        last = end
    return [(n, re.sub(r"`[^`\n]+`", blank, content.replace("\\n", "  ").replace('\\"', "  "))) for n, content in chunks]


CPP = re.compile(r'//[^\n]*|/\*.*?\*/|^[ \t]*#[ \t]*include[^\n]*|R"(?P<mark>\w*)\((?P<raw>.*?)\)(?P=mark)"|"(?P<text>(?:\\.|[^"\\\n])*)"|\'(?:\\.|[^\'\\\n])\'', re.M | re.S)


def cpp_literals(text):
    return joined([(m.start(), m.end(), m["raw"] or m["text"] or "") for m in CPP.finditer(text) if m["raw"] is not None or m["text"] is not None], text)


def python_literals(text):
    """As of C++; raw strings (expressions) do not count, nor what f-strings compute."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    found = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.STRING:
            kind, content = re.match(r"(\w*)(?:\"{3}|\'{3}|\"|\')(.*?)(?:\"{3}|\'{3}|\"|\')$", token.string, re.S).groups()
            if "r" not in kind.lower():
                content = re.sub(r"\{[^{}\n]*\}", blank, content) if "f" in kind.lower() else content
                found.append((starts[token.start[0] - 1] + token.start[1], starts[token.end[0] - 1] + token.end[1], content))
    return joined(found, text)


def yaml_texts(text):
    """[(line, text)] of all names and values."""
    def texts(node):
        if isinstance(node, yaml.ScalarNode):
            yield node.start_mark.line + 1 + (node.style == "|"), node.value
            return
        for child in node.value:
            for part in child if isinstance(child, tuple) else (child,):
                yield from texts(part)
    return [(line, re.sub(r"`[^`\n]+`", blank, value)) for line, value in texts(yaml.compose(text, yaml.SafeLoader))]


def check(path, text, words, allowed):
    """Avoided words of one file: path:line: 'word': what to write."""
    chunks = {".md": prose, ".cpp": cpp_literals, ".hpp": cpp_literals, ".yaml": yaml_texts}.get(pathlib.PurePosixPath(path).suffix, python_literals)(text)
    found, any_of = set(), one_of(tuple(word for word, _ in words))
    for first, chunk in chunks:
        if " " not in chunk or not any_of.search(chunk):
            continue  # a key or a name; or none of the words
        for phrase in allowed:
            chunk = phrase.sub(blank, chunk)
        for word, but in words:
            found |= {(first + chunk.count("\n", 0, match.start()), " ".join(match.group().split()), but) for match in word.finditer(chunk)}
    return [f"{path}:{line}: '{word}': {but} (docs/glossary.md)" for line, word, but in sorted(found)]


def tracked(root):
    listed = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=False).stdout.splitlines()
    return listed or [str(f.relative_to(root)) for f in root.rglob("*") if f.is_file() and not any(p.startswith((".", "build", "out")) for p in f.relative_to(root).parts)]


def is_document(path):
    return path.endswith(".md") and not re.fullmatch(f"{GENERATED}|docs/glossary.md", path)


def is_message(path, root):
    if not path.startswith(SOURCES) or path.endswith((".md", ".h")):
        return False
    if path.endswith(".yaml"):
        return path.startswith("scripts/validation/tables/")
    return path.endswith((".cpp", ".hpp", ".py")) or (root / path).read_bytes().startswith((b"#!/usr/bin/python", b"#!/usr/bin/env python"))


def main(root, option):
    words, allowed = table((root / "docs/glossary.md").read_text())
    paths = [p for p in tracked(root) if (root / p).is_file()]
    files = [p for p in paths if option != "--messages" and is_document(p)]
    files += [p for p in paths if (option == "--messages" or not option) and is_message(p, root)]
    trouble = [line for path in files for line in check(path, (root / path).read_text(), words, allowed)]
    print("\n".join(trouble) or f"{len(files)} files, {len(words)} expressions: in order")
    if trouble:
        print(f"{len(trouble)} avoided words")
    return 1 if trouble or len(words) < 40 else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2] if len(sys.argv) > 2 else None))
