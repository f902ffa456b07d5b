# SPDX-License-Identifier: Apache-2.0
"""Writes and checks cut meshes (NAME.h5) for cases that are too large for one process: any number of ranks can read
such a mesh, each its own part. 'cut SOURCE' converts the meshes of a case, or one mesh file, in one process that
reads it as a whole. 'box' writes a box of hexahedra or tetrahedra in parallel. 'open SOURCE' opens a mesh as the
programs do and prints the time and memory required."""
import pathlib
import subprocess

from couplet import files, places
from couplet.command.run import build_of
from couplet.runs.case import Case, expect, with_changes
from couplet.runs.job import surroundings

OPENED_BY = ("fluid_solver", "solid_solver", "mesh_mover")


def declare(parser):
    parser.add_argument("what", choices=("cut", "box", "open"), metavar="cut|box|open", help="action")
    parser.add_argument(
        "source",
        nargs="?",
        type=pathlib.Path,
        metavar="SOURCE",
        help="cut: a case (YAML file, or folder with case.yaml) or a mesh file; open: a mesh file",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=pathlib.Path,
        metavar="FILE.h5",
        help="cut mesh to write (default for cut: next to the mesh, with the same name)",
    )
    parser.add_argument("--participant", metavar="NAME", help="cut: only the mesh of this participant")
    parser.add_argument(
        "--set", action="append", default=[], metavar="a.b=v", help="cut: sets a value of the case first; repeatable"
    )
    parser.add_argument(
        "--dimension",
        type=int,
        choices=(2, 3),
        default=3,
        metavar="2|3",
        help="cut and open: dimension of a mesh file (default: 3)",
    )
    parser.add_argument(
        "--parameter",
        action="append",
        default=[],
        metavar="NAME=NUMBER",
        help="cut: value of a name that the .geo defines; repeatable",
    )
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help="allows a .geo to run commands and write files, with your permissions",
    )
    parser.add_argument("--cells", nargs=3, type=int, metavar=("NX", "NY", "NZ"), help="box: hexahedra along x, y, z")
    parser.add_argument(
        "--length",
        nargs=3,
        type=float,
        metavar=("LX", "LY", "LZ"),
        help="box: lengths of its sides [m] (default: 1 1 1)",
    )
    parser.add_argument("--tetrahedra", action="store_true", help="box: divides each hexahedron into six tetrahedra")
    parser.add_argument(
        "-n", "--ranks", type=int, default=1, metavar="N", help="box and open: number of ranks (default: 1)"
    )
    parser.add_argument("--bin", type=pathlib.Path, metavar="FOLDER", help="folder that contains the programs")


def tool(arguments, words, ranks=1):
    """Runs mesh_tool, which does the work. Returns its exit code."""
    program = (build_of(arguments.bin) or places.build()) / "bin/mesh_tool"
    expect(program.exists(), f"{program}: is not built")
    launcher = ["mpirun", "--oversubscribe", "-n", ranks] if ranks > 1 else []
    allowed = {"COUPLET_ALLOW_COMMANDS": "1"} if arguments.allow_commands else {}
    return subprocess.run([str(w) for w in (*launcher, program, *words)], env={**surroundings(), **allowed}).returncode


def meshes_of(case, arguments):
    """Returns {(mesh file, dimension, parameters): participants} of the meshes in the case."""
    expect(all("=" in s for s in arguments.set), "--set: expected a.b=value")
    data = with_changes(case.data, dict(s.split("=", 1) for s in arguments.set))
    entries, found = data["participants"], {}
    expect(
        arguments.participant is None or arguments.participant in entries,
        f"{case.file}: there is no participant '{arguments.participant}'",
    )
    for name, entry in entries.items():
        if arguments.participant not in (None, name) or entry.get("program") not in OPENED_BY or "mesh" not in entry:
            continue
        parameters = tuple(f"{key}={value}" for key, value in (entry.get("mesh-parameters") or {}).items())
        found.setdefault((str(entry["mesh"]), int(entry.get("dimension", 3)), parameters), []).append(name)
    expect(found, f"{case.file}: no participant has a mesh that can be cut; those of {', '.join(OPENED_BY)} can")
    return found


def cut(arguments, source, dimension, parameters, output):
    return tool(
        arguments,
        ["cut", source, "-o", output, "--dimension", dimension, *(w for p in parameters for w in ("--parameter", p))],
    )


def beside(folder, mesh):
    """Cut mesh beside a mesh of a case. A case may name a mesh elsewhere, but not lead there through links below its
    own folder."""
    place = pathlib.PurePath(mesh).with_suffix(".h5")
    return folder / place if place.is_absolute() or ".." in place.parts else files.below(folder, place)


def cut_case(arguments):
    case = Case(arguments.source)
    found = meshes_of(case, arguments)
    outputs = {key: arguments.output or beside(case.file.parent, key[0]) for key in found}
    expect(
        len(set(outputs.values())) == len(found),
        (
            f"{case.file}: several meshes would become {outputs[next(iter(found))]}; cut one at a time: --participant"
            " NAME -o FILE.h5"
        ),
    )
    for (mesh, dimension, parameters), names in found.items():
        expect(
            pathlib.Path(mesh).suffix != ".h5",
            f"{case.file}: participants.{names[0]}.mesh: '{mesh}' is a cut mesh already",
        )
        output = outputs[mesh, dimension, parameters]
        code = cut(arguments, case.file.parent / mesh, dimension, parameters, output)
        if code != 0:
            return code
        shown = output.name if output.absolute().parent == case.file.absolute().parent else output
        for name in names:
            print(
                f"to use it in a run, set: participants.{name}.mesh: {shown}"
                + (", without mesh-parameters" if parameters else ""),
                flush=True,
            )
    return 0


def run(arguments):
    given = {
        "--output": arguments.output,
        "--cells": arguments.cells,
        "--length": arguments.length,
        "--tetrahedra": arguments.tetrahedra or None,
    }
    allowed = {"cut": ("--output",), "box": tuple(given), "open": ()}[arguments.what]
    for option, value in given.items():
        expect(value is None or option in allowed, f"couplet mesh {arguments.what}: {option} is not an option of it")
    expect(
        arguments.ranks > 0 and (arguments.ranks == 1 or arguments.what != "cut"),
        "-n: cutting runs on one process; box and open on any number of ranks",
    )
    expect(
        (arguments.source is None) == (arguments.what == "box"),
        f"couplet mesh {arguments.what}: " + ("takes no SOURCE" if arguments.what == "box" else "SOURCE is missing"),
    )
    if arguments.what == "box":
        expect(arguments.cells and arguments.output, "couplet mesh box: --cells NX NY NZ and -o FILE.h5 are needed")
        words = [
            "box",
            "-o",
            arguments.output,
            "--cells",
            *arguments.cells,
            *(["--length", *arguments.length] if arguments.length else []),
            *(["--tetrahedra"] if arguments.tetrahedra else []),
        ]
        return tool(arguments, words, arguments.ranks)
    if arguments.what == "open":
        return tool(arguments, ["open", arguments.source, "--dimension", arguments.dimension], arguments.ranks)
    if arguments.source.is_dir() or arguments.source.suffix in (".yaml", ".yml"):
        return cut_case(arguments)
    expect(
        not arguments.set and arguments.participant is None,
        "couplet mesh cut: --set and --participant belong to a case",
    )
    return cut(
        arguments,
        arguments.source,
        arguments.dimension,
        arguments.parameter,
        arguments.output or arguments.source.with_suffix(".h5"),
    )
