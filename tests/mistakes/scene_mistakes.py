# SPDX-License-Identifier: Apache-2.0
"""Patches, meshes, programs and files."""
import pathlib

SQUARE = (pathlib.Path(__file__).parent / "square.msh").read_text(encoding="utf-8")
def bar(height, along, across):
    """A rectangle of length 1 in `along` by `across` cells."""
    return f"""Point(1) = {{0, 0, 0}}; Point(2) = {{1, 0, 0}}; Point(3) = {{1, {height}, 0}}; Point(4) = {{0, {height}, 0}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Curve Loop(1) = {{1:4}}; Plane Surface(1) = {{1}};
Transfinite Curve {{1, 3}} = {along + 1}; Transfinite Curve {{2, 4}} = {across + 1}; Transfinite Surface {{1}}; Recombine Surface {{1}};
Physical Curve("bottom") = {{1}}; Physical Curve("right") = {{2}}; Physical Curve("top") = {{3}}; Physical Curve("left") = {{4}}; Physical Surface("body") = {{1}};
"""
SHARED = SQUARE.replace("\n12\n1 1 2 3 1 1 2\n", "\n13\n1 1 2 3 1 1 2\n13 1 2 2 1 1 2\n")
OPEN = """Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1, 1, 0}; Point(4) = {0, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4};
Curve Loop(1) = {1, 2, 3}; Plane Surface(1) = {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("top") = {3}; Physical Curve("left") = {3};
Physical Surface("inside") = {1};
"""
TOUCHING = """*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
5, 1, 0
6, 2, 0
7, 2, 1
8, 1, 1
*ELEMENT, TYPE=CPS4, ELSET=body
1, 1, 2, 3, 4
2, 5, 6, 7, 8
*NSET, NSET=left
1, 4
*NSET, NSET=right
6, 7
"""
TWO_PARTS = [("square.msh", "parts.inp"), ("      bottom: {type: free}\n      top: {type: free}\n", "      rest: {type: free}\n")]
HOLD = "{type: fixed-displacement, value: [0, 0]}"
SPATIAL = [("dimension: 2", "dimension: 3"), ("value: [0, 0]", "value: [0, 0, 0]"), ("[1 MPa, 0]", "[1 MPa, 0, 0]"), ("[1, 1]", "[1, 1, 0]")]
MISTAKES = [
    ("no mistake: solid", "solid", [], "right", {"message": "the case that the others differ from", "run": True}),
    ("no mistake: coupled", "coupled", [], "right", {"message": "the case that the others differ from", "run": True}),
    ("wrong sign of a pressure", "solid", [("{type: traction, value: [1 MPa, 0]}", "{type: pressure, value: -1 MPa}")], "right",
     {"message": "a pressure below that of the surroundings pulls; the docs of the key say what is positive", "run": True}),
    ("patch with a misspelt name", "solid", [("      right:", "      rigth:")], "refused",
     {"message": "boundaries.rigth: the mesh has no patch with this name. Did you mean 'right'?"}),
    ("patch without an entry", "solid", [("      top: {type: free}\n", "")], "refused", {"message": "the patch 'top' of the mesh has no entry here."}),
    ("nothing holds the solid", "solid", [(HOLD, "{type: free}")], "refused", {"message": "no patch supports the solid in this static analysis"}),
    ("plane mesh in three dimensions", "solid", SPATIAL + [("    plane: stress\n", "")], "refused", {"message": "dimension", "run": True}),
    ("plane stress in three dimensions", "solid", SPATIAL, "refused", {"message": "plane: only for 2-dimensional scenes; remove this key."}),
    ("plane strain for plane stress", "solid", [("plane: stress", "plane: strain")], "right",
     {"message": "both are scenes; --explain names the one in force"}),
    ("plane as a word of another program", "solid", [("plane: stress", "plane: plane-stress")], "refused", {"message": "'plane-stress' is not one of: strain, stress, axisymmetric."}),
    ("restart into the output folder of the first run", "solid", [], "right",
     {"message": "a run continues its own results", "run": True, "twice": ["--restart", "out/checkpoints", "--set", "simulation.end-time=2 s"]}),
    ("restart of another material", "solid", [], "refused",
     {"message": "youngs-modulus", "run": True, "twice": ["--restart", "out/checkpoints", "--set", "simulation.end-time=2 s", "--set",
                                                         "participants.solid.material.youngs-modulus=70 GPa"]}),
    ("restart beyond the end", "fluid", [], "refused",
     {"message": "its time, 1 s, is beyond the end of the run ('simulation.end-time': 0.5 s); set a later end-time.", "run": True,
      "twice": ["--restart", "out/checkpoints", "--set", "simulation.end-time=0.5 s"]}),
    ("a table with decimal commas", "solid", [("[1 MPa, 0]", "[{of: t, file: p.csv, column: p}, 0]")], "refused",
     {"message": "p.csv:2: '0,0' has a decimal comma; write 0.0", "files": {"p.csv": "t;p\n0,0;1000,5\n1,5;2000,5\n"}}),
    ("a table whose unit stands in round brackets", "solid", [("[1 MPa, 0]", "[{of: t, file: p.csv, column: 2}, 0]")], "refused",
     {"message": "p.csv:1: 'p (kPa)' has its unit in round brackets, where it is not read. Write 'p [kPa]'.", "files": {"p.csv": "t,p (kPa)\n0,0\n1,5\n"}}),
    ("thermal strain forgotten at one temperature", "solid", [("poissons-ratio: 0.3", "poissons-ratio: 0.3\n      expansion: 1.2e-5"), ("    probes:", "    temperature: 400 degC\n    probes:")], "flagged",
     {"message": "a temperature change of 380 K would strain a free body with 1.2e-05 1/K by 0.0046", "run": True}),
    ("loads that buckle a slender body, in motion", "solid", [("square.msh", "column.geo"), ("analysis: static", "analysis: dynamic"), ("1 MPa, 0", "-20 MPa, 0"), ("[1, 1]", "[1, 0]")], "flagged",
     {"message": "if these loads last, the body buckles", "run": True, "files": {"column.geo": bar(0.01, 80, 4)}}),
    ("a coarse mesh beside a temperature that does nothing", "solid",
     [("square.msh", "beam.geo"), ("1 MPa, 0", "0, -1 MPa"), ("    probes:", "    temperature: 20 degC\n    probes:"), ("[1, 1]", "[1, 0]")], "flagged",
     {"message": "displacement not reliable; refine the mesh", "run": True, "files": {"beam.geo": bar(0.1, 10, 1)}}),
    ("an unusual value with --strict", "solid", [("density: 7850 kg/m^3", "density: 7.85e-9")], "refused",
     {"message": "questionable-key", "run": True, "twice": ["--strict"], "code": 1}),
    ("an unusual value that is accepted", "solid", [("density: 7850 kg/m^3", "density: 7.85e-9")], "flagged",
     {"message": "7.85e-09 kg/m^3 (usual: 1 to 25000 kg/m^3)", "run": True, "twice": ["--strict", "--accept", "questionable-key"]}),
    ("two patches on one face", "solid", [("square.msh", "shared.msh")], "refused",
     {"message": "The boundary face at (0.25, 0) is in two patches, 'bottom' and 'right'. Every boundary face must be in exactly one patch.", "run": True,
      "files": {"shared.msh": SHARED}}),
    ("parts that touch but share no points", "solid", TWO_PARTS, "refused",
     {"message": "mesh: 2 faces of patch 'rest', the first at (1, 0.5), touch faces of the same patch without sharing their points", "run": True,
      "files": {"parts.inp": TOUCHING}}),
    ("parts that touch and are tied", "solid", TWO_PARTS + [("dimension: 2", "dimension: 2\n    touching-faces: tie")], "right",
     {"message": "the load passes from part to part", "run": True, "files": {"parts.inp": TOUCHING}}),
    ("parts that touch and are tied, but with other points", "solid", TWO_PARTS + [("dimension: 2", "dimension: 2\n    touching-faces: tie")], "refused",
     {"message": "so 'touching-faces: tie' cannot join them", "run": True, "files": {"parts.inp": TOUCHING.replace("8, 1, 1", "8, 1, 0.8")}}),
    ("a load on faces that are tied", "solid", [TWO_PARTS[0], (TWO_PARTS[1][0], TWO_PARTS[1][1] + "      joint: {type: pressure, value: 1 MPa}\n"), ("dimension: 2", "dimension: 2\n    touching-faces: tie")], "refused",
     {"message": "boundaries.joint: all faces of this patch are tied to other faces", "run": True, "files": {"parts.inp": TOUCHING + "*NSET, NSET=joint\n2, 3\n"}}),
    ("geometry that is not closed", "solid", [("square.msh", "open.geo")], "refused",
     {"message": "gmsh could not mesh 'open.geo'", "run": True, "files": {"open.geo": OPEN}}),
    ("interface on the wrong side", "coupled", [("bottom: {type: fixed-displacement, value: [0, 0]}", "bottom: {type: interface}"),
                                                ("      top: {type: interface}", "      top: {type: fixed-displacement, value: [0, 0]}")],
     "refused", {"message": "match none of", "run": True}),
    ("interface forgotten on one side", "coupled", [("      top: {type: interface}", "      top: {type: free}")], "refused",
     {"message": "There are 0 vertices of 'solid' and 3 vertices of 'mover', but an interface needs some on both sides.", "run": True}),
    ("one of two meshes in millimetres", "coupled", [("mesh: below.msh", "mesh: below.msh\n    mesh-scale: 1e-3")], "refused",
     {"message": "match none of", "run": True}),
    ("one participant in two roles", "coupled", [("structure: {participant: solid}", "structure: {participant: fluid}")], "refused",
     {"message": "fluid and structure must be two different participants."}),
    ("swapped roles", "coupled", [("  fluid: {participant: fluid}", "  fluid: {participant: mover}"), ("  mesh: {participant: mover}", "  mesh: {participant: fluid}")],
     "refused", {"message": "'mover' is run by mesh_mover, which cannot be the fluid"}),
    ("no role for a participant", "coupled", [("  mesh: {participant: mover}\n", "")], "refused", {"message": "this participant has no role in `coupling`"}),
]
