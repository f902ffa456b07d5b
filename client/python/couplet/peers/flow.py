# SPDX-License-Identifier: Apache-2.0
"""Laminar incompressible flow of a case as an OpenFOAM case for icoFoam or pimpleFoam, and its results."""
import pathlib

import numpy as np

from couplet import files
from couplet.peers import mesh
from couplet.peers.foam_files import PolyMesh, foam_environment, last_time, one, put, read_field, read_rows, values
from couplet.peers.results import write_fields, write_table
from couplet.peers.values import EVERYWHERE, depends_on_time, field, number, only, refuse, settled, vector

PROGRAMS = ("icoFoam", "pimpleFoam")
HERE = EVERYWHERE | set("density viscosity initial-velocity initial-pressure compressibility statistics".split())
HERE |= set(
    "time-step safety-factor viscous implicit-stretch pressure-tolerance".split()
)  # of no effect on what is solved
MOVING = {"velocity", "ramp"}
PATCHES = {
    "inlet": MOVING | {"mean-speed", "profile"},
    "outlet": {"pressure", "backflow-stabilisation"},
    "no-slip": set(),
    "moving-wall": MOVING,
    "slip": set(),
    "symmetry": set(),
}
WALLS = ("no-slip", "moving-wall")
COURANT = 0.7
FASTER = 1.5  # assumed ratio of the largest inner and boundary speeds, for icoFoam's time step
SAMPLES = 400  # number of times for a transient velocity, linear in between
ROWS = 4000  # maximum number of forces and probes


class Flow:
    """Checked participant `name` of the sections `data`. Keys without a counterpart in OpenFOAM are rejected by name."""

    def __init__(self, data, name, folder, work, trusted=False):
        self.name, self.where, self.section = name, f"participants.{name}", data["participants"][name]
        self.folder, self.work, self.trusted, self._mesh = folder, work, trusted, None
        settled(data)
        only(self.section, self.where, HERE, "OpenFOAM's icoFoam and pimpleFoam")
        self.dimension = int(self.section.get("dimension", 3))
        self.end = number(data["simulation"]["end-time"], "simulation.end-time")
        self.density, self.viscosity = (number(self.section[k], f"{self.where}.{k}") for k in ("density", "viscosity"))
        self.boundaries = {
            p: g if isinstance(g, dict) else {"type": g} for p, g in (self.section.get("boundaries") or {}).items()
        }
        for patch, given in self.boundaries.items():
            where, kind = f"{self.where}.boundaries.{patch}", given.get("type")
            if kind not in PATCHES:
                refuse(
                    f"{where}.type",
                    f"'{kind}' has no counterpart in the exported OpenFOAM case; only {', '.join(PATCHES)} have one",
                )
            only(given, where, PATCHES[kind] | {"type"}, "the exported OpenFOAM case")
            if given.get("profile", "uniform") != "uniform":
                refuse(f"{where}.profile", f"'{given['profile']}' is not exported; give the velocity as an expression")

    def mesh(self):
        """Returns (mesh of the case, its cells in 3-D, its faces)."""
        if self._mesh is None:
            flat = mesh.of_participant(self.section, self.folder, self.where, self.work, 1, self.trusted)
            self.depth = flat.size() if self.dimension == 2 else 1.0
            body = flat.extruded(self.depth) if self.dimension == 2 else flat
            kinds = {
                p: "wall" if g["type"] in WALLS else "symmetry" if g["type"] == "symmetry" else "patch"
                for p, g in self.boundaries.items()
            }
            mesh.check_patches(flat, kinds, self.where)
            self._mesh = flat, body, PolyMesh(body, kinds)
        return self._mesh

    def velocity(self, patch, time):
        """Velocities (faces, 3) [m/s] at the face centers of a patch."""
        given, faces = self.boundaries[patch], self.mesh()[2]
        where, middles = f"{self.where}.boundaries.{patch}", faces.middles_of(patch)
        found = np.zeros((len(middles), 3))
        if given.get("velocity"):
            found += vector(given["velocity"], f"{where}.velocity", self.flat(middles), time, self.dimension)
        if "mean-speed" in given:
            found -= field(given["mean-speed"], f"{where}.mean-speed", self.flat(middles), time)[
                :, None
            ] * faces.normals_of(patch)
        if "ramp" in given:
            ramp = number(given["ramp"], f"{where}.ramp")
            found *= (1 - np.cos(np.pi * min(time / ramp, 1))) / 2
        return found

    def flat(self, places):
        """Positions in the coordinates of the case: z = 0 for a plane one."""
        return places * (1, 1, 0) if self.dimension == 2 else places

    def changes(self, patch):
        given = self.boundaries[patch]
        return (
            "ramp" in given or depends_on_time(given.get("velocity", [])) or depends_on_time(given.get("mean-speed", 0))
        )

    def times(self):
        return np.linspace(0, self.end, SAMPLES + 1)

    def fastest(self):
        """Largest prescribed speed [m/s]."""
        found = [
            np.zeros((1, 3)),
            *(
                self.velocity(p, t)
                for p, g in self.boundaries.items()
                if g["type"] in ("inlet", "moving-wall")
                for t in (self.times() if self.changes(p) else [0.0])
            ),
        ]
        if self.section.get("initial-velocity"):
            found.append(self.initial())
        return max(float(np.linalg.norm(v, axis=1).max()) for v in found)

    def initial(self):
        centres = self.mesh()[2].centres
        given = self.section.get("initial-velocity")
        return (
            vector(given, f"{self.where}.initial-velocity", self.flat(centres), 0, self.dimension)
            if given
            else np.zeros((len(centres), 3))
        )


class FlowCase:
    """OpenFOAM case for one of PROGRAMS."""

    environment = staticmethod(foam_environment)

    def __init__(self, flow, program):
        self.flow, self.program = flow, program

    def steps(self):
        """Number of equal steps that keep the Courant number near COURANT, from the smallest cell and the largest prescribed speed."""
        fastest = self.flow.fastest()
        if fastest == 0 and self.program == "icoFoam":
            refuse(
                f"{self.flow.where}.boundaries",
                (
                    "the step of icoFoam is chosen from a prescribed velocity, but there is none; pimpleFoam chooses"
                    " its own step"
                ),
            )
        step = COURANT * self.flow.mesh()[0].size() / (FASTER * fastest) if fastest > 0 else self.flow.end / 1000
        return max(1, int(np.ceil(self.flow.end / step)))

    def velocities(self, folder):
        """Entries of 0/U by patch. Transient velocities are written to constant/boundaryData."""
        flow, found = self.flow, {}
        for patch, given in flow.boundaries.items():
            kind = given["type"]
            if kind in ("inlet", "moving-wall"):
                found[patch] = f"type fixedValue; value {values(flow.velocity(patch, 0.0))};"
                if flow.changes(patch):
                    self.table(folder, patch)
                    found[patch] = (
                        "type timeVaryingMappedFixedValue; offset (0 0 0); setAverage false; mapMethod nearest;"
                    )
            else:
                found[patch] = {
                    "outlet": "type inletOutlet; inletValue uniform (0 0 0); value uniform (0 0 0);",
                    "no-slip": "type noSlip;",
                    "slip": "type slip;",
                    "symmetry": "type symmetry;",
                }[kind]
        return found

    def table(self, folder, patch):
        place = f"constant/boundaryData/{patch}"
        rows = lambda found: f"{len(found)}\n(\n" + "\n".join(map(one, found)) + "\n)\n"  # noqa: E731
        files.write(folder, f"{place}/points", rows(self.flow.mesh()[2].middles_of(patch)))
        for t in self.flow.times():
            files.write(folder, f"{place}/{t:.9g}/U", rows(self.flow.velocity(patch, t)))

    def pressures(self):
        """Entries of 0/p by patch, divided by the density."""
        flow, found = self.flow, {}
        for patch, given in flow.boundaries.items():
            if given["type"] == "outlet":
                where, value = f"{flow.where}.boundaries.{patch}.pressure", given.get("pressure", 0)
                if depends_on_time(value):
                    refuse(where, "a pressure that changes in time is not exported")
                found[patch] = (
                    "type fixedValue; value"
                    f" {values(field(value, where, flow.flat(flow.mesh()[2].middles_of(patch)), 0) / flow.density)};"
                )
            else:
                found[patch] = "type symmetry;" if given["type"] == "symmetry" else "type zeroGradient;"
        return found

    def functions(self, every):
        walls = [p for p, g in self.flow.boundaries.items() if g["type"] in WALLS]
        rows = f"log false; writeControl timeStep; writeInterval {every};"
        text = [
            f"forces-{w}{{type forces; libs (forces); patches ({w}); rho rhoInf; rhoInf {self.flow.density:.12g}; CofR"
            f" (0 0 0); {rows}}}"
            for w in walls
        ]
        points = [self.place(p) for p in (self.flow.section.get("probes") or {}).values()]
        if points:
            text.append(
                "probes{type probes; libs (sampling); fields (U p); interpolationScheme cellPoint; probeLocations"
                f" ({' '.join(map(one, points))}); {rows}}}"
            )
        return "functions{" + "\n".join(text) + "}"

    def place(self, probe):
        """Moves a probe to the middle of the depth, and from the rim inside by a millionth of the size, where OpenFOAM finds a cell."""
        points = self.flow.mesh()[1].points
        low, high = points.min(axis=0), points.max(axis=0)
        at = np.array([*map(float, probe["point"]), *([self.flow.depth / 2] if self.flow.dimension == 2 else [])])
        return np.clip(at, low + 1e-6 * (high - low), high - 1e-6 * (high - low))

    def write(self, folder):
        """Writes all files of the case. Run it there with its program."""
        flow, steps = self.flow, self.steps()
        flat, _, faces = flow.mesh()
        faces.write(folder)
        empty = " frontAndBack{type empty;}" if flow.dimension == 2 else ""

        def entries(found):
            return "boundaryField{" + "\n".join(f"{patch}{{{text}}}" for patch, text in found.items()) + empty + "}"

        centres = flow.flat(faces.centres)
        p = field(flow.section.get("initial-pressure", 0), f"{flow.where}.initial-pressure", centres, 0) / flow.density
        put(
            folder,
            "0/U",
            "volVectorField",
            f"dimensions [0 1 -1 0 0 0 0]; internalField {values(flow.initial())};\n{entries(self.velocities(folder))}",
        )
        put(
            folder,
            "0/p",
            "volScalarField",
            f"dimensions [0 2 -2 0 0 0 0]; internalField {values(p)};\n{entries(self.pressures())}",
        )
        put(
            folder,
            "constant/transportProperties",
            "dictionary",
            f"transportModel Newtonian; nu [0 2 -1 0 0 0 0] {flow.viscosity / flow.density:.12g};",
        )
        put(folder, "constant/turbulenceProperties", "dictionary", "simulationType laminar;")
        level = "" if any(g["type"] == "outlet" for g in flow.boundaries.values()) else " pRefCell 0; pRefValue 0;"
        loops = f"nCorrectors 2; nNonOrthogonalCorrectors 0;{level}"
        put(
            folder,
            "system/fvSolution",
            "dictionary",
            (
                "solvers{p{solver GAMG; smoother GaussSeidel; tolerance 1e-6; relTol 0.05;} pFinal{$p; relTol"
                " 0;}\n\"(U|UFinal)\"{solver smoothSolver; smoother symGaussSeidel; tolerance 1e-6; relTol"
                f" 0;}}}}\nPISO{{{loops}}}\nPIMPLE{{nOuterCorrectors 1; {loops}}}"
            ),
        )
        put(
            folder,
            "system/fvSchemes",
            "dictionary",
            (
                "ddtSchemes{default backward;} gradSchemes{default Gauss linear;}\ndivSchemes{default none; div(phi,U)"
                " Gauss linear; div((nuEff*dev2(T(grad(U))))) Gauss linear;}\nlaplacianSchemes{default Gauss linear"
                " corrected;} interpolationSchemes{default linear;} snGradSchemes{default corrected;}"
            ),
        )
        own = self.program == "pimpleFoam"
        rhythm = (
            f"writeControl {'adjustableRunTime' if own else 'timeStep'}; writeInterval"
            f" {f'{flow.end:.12g}' if own else steps};"
        )
        step = f"adjustTimeStep yes; maxCo {COURANT};" if own else ""
        put(
            folder,
            "system/controlDict",
            "dictionary",
            f"application {self.program}; startFrom startTime; startTime 0; stopAt endTime; endTime"
            f" {flow.end:.12g};\ndeltaT {flow.end / steps:.12g}; {step} {rhythm} writeFormat ascii; writePrecision 10;"
            " timeFormat general; timePrecision 8; runTimeModifiable false;\n"
            + self.functions(max(1, steps // ROWS)),
        )
        return [self.program]

    def read(self, folder, out):
        """Writes the results in `folder` to the participant's folder `out` in the format of our programs."""
        folder, flow = pathlib.Path(folder), self.flow
        last, (flat, _, _) = last_time(folder), flow.mesh()
        files.folder(out, ".")
        count = flat.count()
        u, p = read_field(last / "U", count), read_field(last / "p", count) * flow.density
        if not np.isfinite(u).all():
            raise ValueError(f"{self.program} diverged: velocities are not finite")
        write_fields(out, f"{flow.name}.h5", flat, float(last.name), {"velocity": u, "pressure": p})
        forces = {}
        for wall in (q for q, g in flow.boundaries.items() if g["type"] in WALLS):
            rows = read_rows(
                next((folder / f"postProcessing/forces-{wall}/0").glob("force*.dat"))
            )  # time, total, pressure, viscous
            forces["time [s]"] = rows[:, 0]
            forces |= {
                f"{wall} {part} {axis} [N]": rows[:, 4 + 3 * k + c] / flow.depth
                for k, part in enumerate(("pressure", "viscous"))
                for c, axis in enumerate("xyz"[: flow.dimension])
            }
        if forces:
            write_table(out, "forces.csv", forces)
        probes = flow.section.get("probes") or {}
        if probes:
            u, p = (read_rows(folder / "postProcessing/probes/0" / name) for name in "Up")
            table = {"time [s]": u[:, 0]}
            for k, name in enumerate(probes):
                table |= {
                    f"{name} velocity {axis} [m/s]": u[:, 1 + 3 * k + c]
                    for c, axis in enumerate("xyz"[: flow.dimension])
                }
                table[f"{name} pressure [Pa]"] = p[:, 1 + k] * flow.density
            write_table(out, "probes.csv", table)
