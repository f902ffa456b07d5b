# SPDX-License-Identifier: Apache-2.0
"""What --check finds without running anything: expressions, components, patches, files, names of participants, what does not end
and what runs commands."""

GEO = 'Point(1) = {0, 0, 0};\nPhysical Curve("left") = {1};\nPhysical Curve("right") = {2};\nDefineConstant [ n = 8 ];\n'
KNOWN = ("Known are the variables x, y, z [m] and t [s], the constant pi, the operators + - * / ^ < > == && || ?: and functions such "
         "as sin, cos, exp, sqrt, abs, min, max.")


def cases(Case):
    def solid(name, message, *edits, **more):
        return Case(name, "solid_solver", message, "solid", list(edits), **more)

    def fluid(name, message, *edits, **more):
        return Case(name, "fluid_solver", message, "fluid", list(edits), **more)

    def with_set(*assignments):
        return {"arguments": ["case.yaml", "--check", *(w for a in assignments for w in ("--set", a))]}

    right = [
        solid("a pressure with sign and unit", "", ("{type: traction, value: [1000, 0]}", "{type: pressure, value: -10 MPa}"), exit_code=0),
        solid("a traction with a unit in one component", "", ("[1000, 0]", "[2 bar, 0]"), exit_code=0),
        solid("--set under sections that are not there", "", exit_code=0,
              **with_set("participants.solid.output.stress=true", "simulation.checkpoint.keep=3")),
        solid("3e9 steps", "", ("time-step: 0.5 s", "time-step: 3e-10 s"), exit_code=0),
    ]
    wrong = [
        fluid("an expression of an inlet with an unknown name", "case.yaml:11:27: participants.fluid.boundaries.left.velocity: entry 1 of the list: cannot parse the expression '6*y*(1-Y)' at column 8: unknown name 'Y'. " + KNOWN,
              ("[1 m/s, 0 m/s]", '["6*y*(1-Y)", 0]')),
        fluid("components of an inlet", "case.yaml:11:27: participants.fluid.boundaries.left.velocity: 3 components are given, but the 2-dimensional scene needs 2.", ("[1 m/s, 0 m/s]", "[1, 0, 0]")),
        fluid("--check: patch of a fluid that the mesh has not", """
case.yaml:12:7: participants.fluid.boundaries.rigth: the mesh has no patch with this name. Did you mean 'right'?
case.yaml:10:5: participants.fluid.boundaries: the patch 'right' of the mesh has no entry here.
""", ("right: {type", "rigth: {type")),
        solid("--check: patch without an entry", "case.yaml:13:5: participants.solid.boundaries: the patch 'top' of the mesh has no entry "
              "here.", ("      top: {type: free}\n", "")),
        solid("--check: no such mesh", "case.yaml:6:5: participants.solid.mesh: the file 'circle.msh' does not exist.", ("square.msh", "circle.msh")),
        solid("--check: patches of a .geo", """
case.yaml:16:7: participants.solid.boundaries.bottom: the mesh has no patch with this name. Valid patches: left, right.
case.yaml:17:7: participants.solid.boundaries.top: the mesh has no patch with this name. Valid patches: left, right.
""", ("square.msh", "square.geo"), files={"square.geo": GEO}),
        solid("--check: parameter of a .geo", "--set participants.solid.mesh-parameters.m=3: participants.solid.mesh-parameters.m: the .geo defines no such name with DefineConstant. Did you mean 'n'?", ("square.msh", "square.geo"),
              ("      bottom: {type: free}\n", ""), ("      top: {type: free}\n", ""), files={"square.geo": GEO},
              **with_set("participants.solid.mesh-parameters.m=3")),
        solid("a .geo that runs a command", """
[solid 0] error: gmsh could not mesh 'square.geo' (exit code 1).
  Error   : Could not find /bin/sh: aborting system call
Here a geometry may neither run commands nor use files outside its folder. If it must and you trust the case, start with --allow-commands.
""", ("square.msh", "square.geo"), files={"square.geo": 'SystemCall "touch pwned";\n' + GEO}, arguments=["case.yaml"]),
        solid("--check: nothing holds the solid", "case.yaml:13:5: participants.solid.boundaries: no patch supports the solid in this static analysis: at least one must be fixed, supported, sprung or a plane of symmetry.",
              ("analysis: dynamic", "analysis: static"), ("{type: fixed-displacement, value: [0, 0]}", "{type: free}")),
        solid("a table with a column out of range", "case.yaml:15:31: participants.solid.boundaries.right.value: profile.csv: the table's values must be in a column from 2 to 2, not in '1e300'.",
              ("{type: traction, value: [1000, 0]}", "{type: pressure, value: {of: t, file: profile.csv, column: 1e300}}"),
              files={"profile.csv": "0 1\n1 2\n"}),
        solid("a participant with a folder's name", "case.yaml:3:1: participants: '../up': the name becomes a folder name: it must not contain '/', '\\', "
              "'.' or blanks, nor start with '-'.", ("  solid:\n", "  ../up:\n")),
        solid("a participant without a name", "case.yaml:3:1: participants: '': a participant needs a name.", ("  solid:\n", '  "":\n')),
        solid("a participant called like the checkpoints", "case.yaml:3:1: participants: 'checkpoints': this name is reserved for a folder or file of the run; choose another.", ("  solid:\n", "  checkpoints:\n")),
        solid("more steps than can be counted", "case.yaml:2:29: simulation.time-step: the run would take 1e+15 steps; at most 1e+12 are allowed.", ("time-step: 0.5 s", "time-step: 1e-15 s")),
    ]
    return right, wrong
