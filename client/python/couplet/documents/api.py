# SPDX-License-Identifier: Apache-2.0
"""Page of the Python interface, from its docstrings and annotations, without importing it: mpi4py would start MPI."""
import ast
import re

from couplet.places import PACKAGE

PUBLIC = {  # module: names that users call
    "runs/job.py": ("run",),
    "runs/results.py": ("Results", "read_csv"),
    "series.py": ("FieldSeries", "Surface", "find_series", "find_surface", "surface_names"),
    "fields.py": ("draw", "draw_surface", "draw_mode"),
    "runs/case.py": ("Case", "Wrong"),
    "participant.py": ("Client",),
}
HEAD = """# Python interface

This page lists what the package `couplet` offers to Python programs. `couplet docs` generates it from the package.

```python
"""


def signature(node, owner=""):
    """Returns 'name(arguments) -> type' of a function, with one argument less if it is a method."""
    arguments = ast.unparse(node.args).removeprefix("self").removeprefix(", ")
    returns = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    name = {"__init__": owner, "__iter__": "for event in"}.get(node.name, node.name)
    return f"{name}({arguments}){returns}"


def text(node):
    return re.sub(r"\s*\n\s*", " ", ast.get_docstring(node) or "").strip()


def entries(node):
    """Yields a list entry for each public method of a class that has a docstring, or for a function."""
    for function in node.body if isinstance(node, ast.ClassDef) else [node]:
        if (
            isinstance(function, ast.FunctionDef)
            and text(function)
            and (function.name == "__init__" or function.name[0] != "_")
        ):
            yield f"- `{signature(function, node.name)}`  \n  {text(function)}"


def page():
    """Text of the page."""
    package = ast.parse((PACKAGE / "__init__.py").read_text())
    example = "\n".join(
        line.removeprefix("    ") for line in ast.get_docstring(package).splitlines() if line.startswith("    ")
    )
    lines = [HEAD + example + "\n```\n"]
    for file, names in PUBLIC.items():
        there = {
            node.name: node
            for node in ast.parse((PACKAGE / file).read_text()).body
            if isinstance(node, (ast.ClassDef, ast.FunctionDef))
        }
        lines.append(f"\n## `couplet.{file.removesuffix('.py').replace('/', '.')}`\n")
        for name in names:
            node = there[name]
            lines += [f"\n### `{name}`\n", text(node), ""] if isinstance(node, ast.ClassDef) else []
            lines += entries(node)
    return "\n".join(lines) + "\n"
