# SPDX-License-Identifier: Apache-2.0
"""Small scenes that used to run into a wrong answer silently. Each writes its files into a folder and gives the case file."""
import pathlib

DUCT = """DefineConstant[ nx = 30, ny = 6 ];
Point(1)={0,0,0}; Point(2)={1,0,0}; Point(3)={1,0.2,0}; Point(4)={0,0.2,0};
Line(1)={1,2}; Line(2)={2,3}; Line(3)={3,4}; Line(4)={4,1};
Transfinite Curve{1,3}=nx+1; Transfinite Curve{2,4}=ny+1; Curve Loop(1)={1,2,3,4}; Plane Surface(1)={1}; Transfinite Surface{1}; Recombine Surface{1};
Physical Curve("inlet")={4}; Physical Curve("outlet")={2}; Physical Curve("walls")={1,3}; Physical Surface("duct")={1};
"""


def write(folder, case, **files):
    for name, text in files.items():
        (folder / name.replace("_", ".")).write_text(text)
    (folder / "case.yaml").write_text(case)
    return folder / "case.yaml"


def duct(folder):
    """SF6 at 48 m/s, Mach 0.36."""
    return write(folder, """simulation: {name: duct, end-time: 0.02 s, time-step: 0.005 s, output: {folder: out}}
participants:
  fluid:
    program: fluid_solver
    mesh: duct.geo
    dimension: 2
    density: 6.17 kg/m^3
    viscosity: 1.5e-5 Pa s
    boundaries: {inlet: {type: inlet, velocity: [48, 0]}, outlet: {type: outlet}, walls: {type: no-slip}}
""", duct_geo=DUCT)


def explicit_step(folder, step=0.2):
    """A duct at 1 m/s with a given explicit step; its limit is about 0.01 s."""
    return write(folder, f"""simulation: {{name: duct, end-time: 20 s, time-step: 0.2 s, output: {{folder: out}}}}
participants:
  fluid:
    program: fluid_solver
    mesh: duct.geo
    dimension: 2
    density: 1 kg/m^3
    viscosity: 0.01 Pa s
    viscous: explicit
    time-step: {step} s
    boundaries: {{inlet: {{type: inlet, velocity: [1, 0]}}, outlet: {{type: outlet}}, walls: {{type: no-slip}}}}
""", duct_geo=DUCT)


def folded(folder, fold=True, corner=""):
    """A strip of 4 by 3 cells; folded: two points of its left end lie in its corner."""
    nx, ny = 4, 3
    number = {(i, j): 1 + i + (nx + 1) * j for j in range(ny + 1) for i in range(nx + 1)}
    nodes = [f"{n} {i / nx} {0 if fold and i == 0 and 0 < j < ny else 0.1 * j / ny} 0" for (i, j), n in number.items()]
    sides = {1: [((i, 0), (i + 1, 0)) for i in range(nx)], 2: [((nx, j), (nx, j + 1)) for j in range(ny)],
             3: [((i + 1, ny), (i, ny)) for i in range(nx)], 4: [((0, j + 1), (0, j)) for j in range(ny)]}
    elements = [f"1 2 {tag} {tag} {number[a]} {number[b]}" for tag, lines in sides.items() for a, b in lines]
    elements += [f"3 2 5 5 {number[i, j]} {number[i + 1, j]} {number[i + 1, j + 1]} {number[i, j + 1]}" for j in range(ny) for i in range(nx)]
    names = ["bottom", "right", "top", "left"]
    mesh = "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "5", *(f'1 {k + 1} "{n}"' for k, n in enumerate(names)), '2 5 "strip"',
                      "$EndPhysicalNames", "$Nodes", str(len(nodes)), *nodes, "$EndNodes", "$Elements", str(len(elements)),
                      *(f"{k + 1} {e}" for k, e in enumerate(elements)), "$EndElements", ""])
    motions = corner or 'left: {type: fixed}, right: {type: moving, motion: {translation: ["0.01*t", 0]}}, bottom: {type: slip}'
    return write(folder, f"""simulation: {{end-time: 0.02 s, time-step: 0.01 s, output: {{folder: out}}}}
participants:
  mover:
    program: mesh_mover
    mesh: m.msh
    dimension: 2
    boundaries: {{{motions}, top: {{type: slip}}}}
""", m_msh=mesh)


def pushed_in(folder):
    """The strip, whose lower left corner is pushed across the diagonal of its cell. The cell keeps a positive area."""
    motion = '{type: moving, motion: {displacement: ["9*t*max(0, 1 - 4*x - 30*y)", "1.2*t*max(0, 1 - 4*x - 30*y)"]}}'
    return folded(folder, False, f"left: {motion}, right: {{type: fixed}}, bottom: {motion}")


WRONG_COUPLED = {"programs": ["coupler", "fluid_solver", "tests/toy_wall"], "id": "iteration-of-pressure-and-structure"}


def wrong_coupled(folder):
    """An added mass twice the structure's, explicitly coupled: each pass returns more of the motion than it was given."""
    string = pathlib.Path(__file__).resolve().parents[1] / "coupling/string"
    text = (string / "case.yaml").read_text()
    for old, new in (("surface-density: 10.4632 kg/m^2", "surface-density: 3.3 kg/m^2"), ("scheme: implicit", "scheme: explicit"),
                     ("  acceleration: {type: constant, initial-relaxation: 1}\n", ""), ("  convergence: {relative: 1e-6, max-iterations: 200}\n", "")):
        assert old in text, old
        text = text.replace(old, new)
    return write(folder, text, channel_geo=(string / "channel.geo").read_text())
