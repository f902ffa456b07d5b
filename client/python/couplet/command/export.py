# SPDX-License-Identifier: Apache-2.0
"""Writes the fields of a run for other programs (--to vtk: .vtu files with a .pvd that lists them, for each
participant), or writes a case as input of another program into a folder: CalculiX (static, linear elastic solids) or
OpenFOAM (incompressible, laminar flow for icoFoam and pimpleFoam; static solids for solidDisplacementFoam). A key
without a counterpart there is reported as an error. `couplet study --peers` runs both programs and compares them."""
import pathlib
import shutil
import tempfile

from couplet import files
from couplet.runs.case import Case, expect, with_changes
from couplet.runs.job import run_folder

TO = ("calculix", "openfoam", "vtk")


def declare(parser):
    parser.add_argument(
        "case",
        type=pathlib.Path,
        metavar="CASE",
        help="a YAML file, or a folder with case.yaml; for vtk also the output folder of a run",
    )
    parser.add_argument("--to", required=True, choices=TO, help="the target program")
    parser.add_argument(
        "--folder",
        type=pathlib.Path,
        metavar="FOLDER",
        help="output folder (default: PROGRAM next to the case; for vtk the folder vtk/ of each participant)",
    )
    parser.add_argument("--participant", metavar="NAME", help="participant to export, if the case has several")
    parser.add_argument(
        "--element",
        metavar="KIND",
        help="element of CalculiX, such as C3D20R (default: the second-order one for the cells of the mesh)",
    )
    parser.add_argument(
        "--solver",
        choices=("icoFoam", "pimpleFoam"),
        default="icoFoam",
        help="solver of OpenFOAM for a flow (default: icoFoam)",
    )
    parser.add_argument("--set", action="append", default=[], metavar="a.b=v", help="sets a value; repeatable")
    parser.add_argument(
        "--allow-commands",
        action="store_true",
        help="allows a .geo to run commands and write files, with your permissions",
    )


def made(case, arguments, work):
    """Writer of the case."""
    from couplet.peers.values import refuse

    names = [arguments.participant] if arguments.participant else list(case.participants)
    expect(len(names) == 1, f"{case.file}: --participant: choose one of {', '.join(names)}")
    expect(names[0] in case.participants, f"{case.file}: there is no participant '{names[0]}'")
    data = with_changes(case.data, dict(s.split("=", 1) for s in arguments.set))
    program, common = str(data["participants"][names[0]].get("program")), (data, names[0], case.file.parent, work)
    if program == "fluid_solver" and arguments.to == "openfoam":
        from couplet.peers.flow import Flow, FlowCase

        return FlowCase(Flow(*common, arguments.allow_commands), arguments.solver)
    if program != "solid_solver":
        refuse(f"participants.{names[0]}.program", f"'{program}' has no counterpart in {arguments.to}")
    from couplet.peers.solid import Solid

    if arguments.to == "openfoam":
        from couplet.peers.solid_foam import SolidFoam

        return SolidFoam(Solid(*common, "solidDisplacementFoam", arguments.allow_commands))
    from couplet.peers.calculix import Input, kinds

    solid = Solid(*common, "CalculiX", arguments.allow_commands)
    return Input(solid, arguments.element or kinds(solid)[-1][0])


def new_folder(folder):
    folder = files.below(folder.parent, folder.name)
    expect(
        not folder.exists() or folder.is_dir() and not any(folder.iterdir()),
        f"--folder {folder}: exists and is not empty; choose a new name",
    )
    return folder


def run(arguments):
    expect(all("=" in s for s in arguments.set), "--set: expected a.b=value")
    expect(arguments.element is None or arguments.to == "calculix", "--element: applies to --to calculix only")
    if arguments.to == "vtk":
        from couplet.vtk import write

        expect(not arguments.set, "--set: changes a case; a run is exported as it is")
        out = run_folder(arguments.case)
        expect(out.is_dir(), f"{out}: there is no such output folder; has the case been run?")
        lists = write(out, arguments.folder and new_folder(arguments.folder), arguments.participant)
        expect(lists, f"{out}: there are no field series ({arguments.participant or '*'}/*.h5) in it")
        print("written; open in ParaView:", *lists, sep="\n  ")
        return 0
    case = Case(arguments.case)
    folder = new_folder(arguments.folder or case.file.parent / arguments.to)
    with tempfile.TemporaryDirectory(prefix="couplet-export-") as work:
        try:
            command = made(case, arguments, pathlib.Path(work)).write(folder)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
    print(f"written to {folder}; run it there: {' '.join(command)}")
    return 0
