# SPDX-License-Identifier: Apache-2.0
"""Materials, supports, loads and steps of a deck. Each keyword has a handler in HANDLERS; others are left out with a
note."""
import re

import numpy as np

from couplet.deck.blocks import real
from couplet.deck.patches import Condition, Faces
from couplet.runs.case import expect

# Unit in SI of a quantity, with the powers of length and mass by which a value is converted.
UNITS = {
    "length": ("m", 1, 0),
    "stress": ("Pa", -1, 1),
    "density": ("kg/m^3", -3, 1),
    "acceleration": ("m/s^2", 1, 0),
    "force": ("N", 1, 1),
    "force per depth": ("N", 0, 1),
    "body force": ("N/m^3", -2, 1),
    "conductivity": ("W/(m K)", 1, 1),
    "specific-heat": ("J/(kg K)", 2, 0),
    "film": ("W/(m^2 K)", 0, 1),
    "flux": ("W/m^2", 0, 1),
    "source": ("W/m^3", -1, 1),
    "expansion": ("1/K", 0, 0),
}
SYSTEMS = {"si": (1.0, 1.0), "mm": (1e-3, 1e3)}  # units of length and mass in m and kg
PLANES = {"CPS": "stress", "CPE": "strain", "C2D": "strain", "CAX": "axisymmetric"}
AXES = "xyz"
SUPPORTS = {
    "ENCASTRE": "xyz",
    "PINNED": "xyz",
    "XSYMM": "x",
    "YSYMM": "y",
    "ZSYMM": "z",
    "XASYMM": "yz",
    "YASYMM": "xz",
}
SUPPORTS["ZASYMM"] = "xy"
# Kinds of *DLOAD, *DFLUX, *FILM and their like by keyword and label
LOADS = {"P": "pressure", "TRVEC": "traction", "GRAV": "gravity", "BX": "x", "BY": "y", "BZ": "z"}
LOADS |= {"FLUX S": "flux", "FLUX BF": "source", "FILM F": "convection"}
MOST_CONDITIONS, EXPRESSION = 1000, "write them as an expression of x, y and z in the case"
MOST_FORCES, MOST_PROBES = 100, 10  # at points; probes of one set
SILENT = re.compile(  # the mesh, and what has no effect on the answer
    "HEADING|PREPRINT|NODE|ELEMENT|NSET|ELSET|SURFACE|(END"
    " )?(PART|ASSEMBLY|INSTANCE)|INCLUDE|RESTART|CONTROLS|MONITOR|DEPVAR|.*(OUTPUT|FILE|PRINT|FORMAT)|END STEP"
)
WHY = {
    "TRANSFORM": "the conditions at its nodes are applied in the global directions x, y and z",
    "AMPLITUDE": "loads have their full value",
}
WHY |= dict.fromkeys(
    ("TIE", "CONTACT PAIR", "CONTACT", "EQUATION", "MPC"), "the parts that it connects are separate here"
)


class Physics:
    """Content of a deck. `notes` has (place, text) for all that the case does not say as the deck does."""

    def __init__(self, blocks, mesh, system):
        self.mesh, self.system, self.name = mesh, SYSTEMS[system], mesh.deck.name
        self.notes, self.conditions, self.materials, self.material, self.sections = [], [], {}, None, []
        self.amplitudes, self.point_loads, self.probes, self.volume, self.gravity = {}, [], {}, {}, np.zeros(3)
        self.step, self.procedure, self.is_skipped, self.modes, self.end, self.dt = None, None, False, 0, 1.0, 1.0
        self.is_large = self.is_transient = False
        self.initial, self.temperature, self.absolute_zero, self.temperatures = None, None, None, []
        kinds = {b.values.get("TYPE", "").upper().removeprefix("D")[:3] for b in blocks if b.word == "ELEMENT"}
        planes = sorted({PLANES[kind] for kind in kinds & PLANES.keys()}) if mesh.dim == 2 else [""]
        expect(len(planes) == 1, f"{self.name}: elements of plane {' and '.join(planes)} are mixed.")
        self.plane, self.axes = planes[0], AXES[: mesh.dim]
        self.faces = Faces(mesh, self.plane == "axisymmetric")
        for block in blocks:
            if block.word in PROCEDURES or block.word == "STEP" or not self.is_skipped:
                HANDLERS.get(block.word, Physics.unknown)(self, block)

    def unknown(self, block):
        if not SILENT.fullmatch(block.word):
            self.leave(block, f"*{block.word[:60]}", WHY.get(block.word, "Couplet has no counterpart"))

    def leave(self, block, what, why):
        self.notes.append((block.place, f"{what} is left out: {why}"))

    def si(self, value, kind):
        unit, length, mass = UNITS[kind]
        return f"{value * self.system[0] ** length * self.system[1] ** mass + 0.0:.10g} {unit}"

    def degrees(self, value):
        self.temperatures.append(value)
        return {"degrees": value}

    def over_time(self, block, value, kind):
        """Scales a value by its *AMPLITUDE: as a function of time if the case has time steps, otherwise by the amplitude at
        the end."""
        name = block.values.get("AMPLITUDE", "").upper()
        expect(not name or name in self.amplitudes, f"{block.place}: there is no *AMPLITUDE '{name}' before this line.")
        curve = self.amplitudes.get(name) or (
            ((0, self.end), (0, 1)) if self.is_large and self.procedure == "STATIC" else None
        )
        if not curve or not self.procedure or not value:
            return self.si(value, kind)
        if self.procedure == "DYNAMIC" or self.is_large or self.is_transient:
            return (
                f"{self.si(value, kind).split()[0]}*table(t,"
                f" {', '.join(f'{t:.10g}, {a:.10g}' for t, a in zip(*curve))})"
            )
        return self.si(value * float(np.interp(self.end, *curve)), kind)

    def total(self, terms, kind):
        """Sum of values, each with the block that loads it."""
        texts = [self.over_time(block, value, kind) for block, value in terms]
        if any("table" in text for text in texts):
            return " + ".join(text if "table" in text else text.split()[0] for text in texts)
        return f"{sum(float(text.split()[0]) for text in texts):.10g} {UNITS[kind][0]}"

    def depth(self):
        """Thickness of a plane body; forces of a case are for unit depth."""
        depths = {depth for *_, depth in self.sections} if self.plane in ("stress", "strain") else {1.0}
        expect(
            len(depths) == 1, f"{self.name}: forces on plane sections need one thickness; there are {sorted(depths)}."
        )
        return depths.pop()

    # -- materials -----------------------------------------------------------------------------------------------------
    def begin_material(self, block):
        expect(block.values.get("NAME"), f"{block.place}: *MATERIAL needs NAME=...")
        self.material = self.materials.setdefault(block.values["NAME"].upper(), {"name": block.values["NAME"]})

    def columns(self, block, n=1):
        """Returns n lists of values, and their temperatures."""
        expect(
            self.material is not None and block.rows,
            f"{block.place}: *{block.word} needs data, and a *MATERIAL before it.",
        )
        rows = [[line.number(k, None if k < n else 0) for k in range(n + 1)] for line in block.lines()]
        return [list(column) for column in zip(*rows)]

    def table(self, values, temperatures):
        return (
            {"of": "T", "at": [self.degrees(t) for t in temperatures], "values": values}
            if len(values) > 1
            else values[0]
        )

    def elastic(self, block):
        if not block.values.get("TYPE", "ISO").upper().startswith("ISO"):
            return self.leave(
                block, f"*ELASTIC, TYPE={block.values['TYPE'][:40]}", "write it as 'orthotropic' in the case"
            )
        moduli, ratios, at = self.columns(block, 2)
        self.material["elastic"] = [self.si(e, "stress") for e in moduli], ratios, at

    def thermal(self, block):
        key = block.word.lower().replace(" ", "-")
        values, at = self.columns(block)
        self.material[key] = self.table([self.si(v, key) for v in values], at)

    def density(self, block):
        values, _ = self.columns(block)
        self.material["density"] = self.si(values[0], "density")
        if len(values) > 1:
            self.leave(block, "*DENSITY beyond its first line", "a density is constant")

    def expansion(self, block):
        """Mean coefficients become the slope of the strain, which jumps at each temperature."""
        if not block.values.get("TYPE", "ISO").upper().startswith("ISO"):
            return self.leave(block, "*EXPANSION", "only TYPE=ISO is read")
        means, at = self.columns(block)
        zero, slopes, places = real(block.values.get("ZERO") or "0", block.place), means[:1], at[:1]
        for a, b, t, u in zip(means, means[1:], at, at[1:]):
            expect(t < u, f"{block.place}: the temperatures of *EXPANSION must increase.")
            places += [t + 1e-6 * (u - t), u - 1e-6 * (u - t)]
            slopes += [a + (b - a) / (u - t) * (t - zero), b + (b - a) / (u - t) * (u - zero)]
        if len(at) > 1:
            places, slopes = [*places, at[-1]], [*slopes, means[-1]]
        self.material["expansion"] = self.table([self.si(v, "expansion") for v in slopes], places)

    def plastic(self, block):
        self.material["yield-strength"] = self.si(self.columns(block)[0][0], "stress")
        self.leave(
            block, "*PLASTIC", "Couplet has no plasticity; the run reports where the first yield stress is reached"
        )

    def section(self, block):
        expect(block.values.get("MATERIAL"), f"{block.place}: *SOLID SECTION needs MATERIAL=...")
        if "ORIENTATION" in block.values:
            self.leave(block, "ORIENTATION", "materials are isotropic")
        self.sections.append((block, block.values["MATERIAL"].upper(), block.number(0, 1.0)))

    # -- steps ---------------------------------------------------------------------------------------------------------
    def begin_step(self, block):
        self.step, self.is_skipped = block, False

    def begin_procedure(self, block):
        expect(self.step, f"{block.place}: *{block.word} must follow *STEP.")
        step, has_modes = self.step.values, block.word in ("FREQUENCY", "BUCKLE")
        if self.procedure:
            self.is_skipped = True
            if (
                not (self.procedure == "STATIC" and block.word == "FREQUENCY" and "PERTURBATION" in step)
                or self.is_large
            ):
                return self.leave(
                    self.step,
                    f"the *STEP with *{block.word}",
                    f"a case has only one step, the one with *{self.procedure}",
                )
            self.modes = int(block.number(0))
            return self.notes.append(
                (self.step.place, "the modes of this *STEP are those about the equilibrium of the first")
            )
        self.procedure, self.is_large = block.word, step.get("NLGEOM", "NO").upper() != "NO" and not has_modes
        self.is_transient = (
            block.word not in ("STATIC", "DYNAMIC") and not has_modes and "STEADY STATE" not in block.values
        )
        if has_modes:
            self.modes = int(block.number(0))
        elif block.word == "DYNAMIC" or self.is_large or self.is_transient:
            self.end = block.number(1, 1.0)
            self.dt = block.number(0, self.end if block.word == "STATIC" else None)
            if block.word == "STATIC":
                self.dt = max(self.dt, self.end / 10)
            expect(0 < self.dt <= self.end, f"{block.place}: *{block.word} needs a time step, followed by an end time.")

    # -- supports and loads --------------------------------------------------------------------------------------------
    def act(self, kind, name, block, faces, value):
        """Adds a condition, or its faces to one with the same value."""
        curve = block.values.get("AMPLITUDE")
        for c in self.conditions:
            if (c.kind, c.name, c.value, c.block.values.get("AMPLITUDE")) == (kind, name, value, curve):
                c.faces |= faces
                return
        expect(
            len(self.conditions) < MOST_CONDITIONS,
            f"{block.place}: more than {MOST_CONDITIONS} different loads; {EXPRESSION}.",
        )
        if faces:
            self.conditions.append(Condition(kind, name, block, set(faces), value))

    def groups(self, block):
        """Yields (name, nodes, line) of data about nodes. Lines of single nodes with the same values are one."""
        single = {}
        for line in block.lines():
            word, nodes = line.text(0), self.faces.nodes(line.text(0))
            expect(nodes is not None, f"{line.place}: '{word[:60]}' is neither a number nor the name of an *NSET.")
            if word.isdigit():
                single.setdefault(tuple(line.rows[0][1][1:]), (line, set()))[1].update(nodes)
            else:
                yield word.rsplit(".", 1)[-1], nodes, line
        for line, nodes in single.values():
            yield "nodes", nodes, line

    def boundary(self, block):
        if block.values.get("TYPE", "DISPLACEMENT").upper() != "DISPLACEMENT":
            return self.leave(block, f"*BOUNDARY, TYPE={block.values['TYPE'][:40]}", "only displacements are read")
        for name, nodes, line in self.groups(block):
            axes, value, last = SUPPORTS.get(line.text(1).upper()), line.number(3, 0.0), 0
            if axes is None:
                first = line.number(1)
                last = line.number(2, first)
                axes = [axis for k, axis in enumerate(AXES, 1) if first <= k <= last]
            held = {axis: self.over_time(line, value, "length") for axis in axes if axis in self.axes}
            for kind, keys in (("held", held), ("temperature", last == 11 and {"value": self.degrees(value)})):
                if keys:
                    self.act(kind, name, line, self.between(name, nodes, line), keys)

    def between(self, name, nodes, line):
        """Faces between these nodes. Nodes besides are named."""
        points = self.faces.corners(nodes)
        faces = self.faces.between(points)
        rest = len(points) - len({p for key in faces for p in key})
        if rest or not faces:
            what = f"*{line.word} of {rest} of the {len(points)} nodes of '{name}'"
            self.leave(line, what, "conditions act on faces, but no boundary face has all its corners there")
        return faces

    def distributed(self, block):
        for line in block.lines():
            if line.text(0).upper() in LOADS:  # of the whole model
                line.rows[0][1].insert(0, "")
            target, label = line.text(0), line.text(1).upper()
            own = self.faces.cells(target) if target else set(range(len(self.mesh.cells)))
            name, face = target.rsplit(".", 1)[-1], re.fullmatch("([PSF])([1-6])", label)
            faces = self.faces.of_cells(own or (), int(face[2])) if face else self.faces.of_surface(target)
            if face:
                name, label = "elements" if target.isdigit() else f"{name}-{label}", face[1]
            kind = LOADS.get(next((w + " " for w in ("FLUX", "FILM") if w in block.word), "") + label)
            on_faces = kind in ("pressure", "traction", "flux", "convection")
            if not kind or (not faces if on_faces else len(own or ()) < len(self.mesh.cells)):
                why = (
                    "Couplet has no counterpart"
                    if not kind
                    else "there is no boundary face" if on_faces else "it acts on a part"
                )
                self.leave(line, f"*{block.word} {label[:20]} of '{target[:60]}'", why)
                continue
            value, vector = line.number(2), [
                line.number(3 + k) for k in range(3 if kind in ("traction", "gravity") else 0)
            ]
            if kind == "pressure":
                self.act(kind, name, line, faces, value)
            elif kind == "traction":
                self.act(
                    kind, name, line, faces, tuple(value * v / (float(np.linalg.norm(vector)) or 1) for v in vector)
                )
            elif kind == "convection":
                keys = {"coefficient": self.si(line.number(3), "film"), "ambient": self.degrees(value)}
                self.act(kind, name, line, faces, keys)
            elif kind == "flux":
                self.act(kind, name, line, faces, {"value": self.over_time(line, value, "flux")})
            elif kind == "gravity":
                self.gravity += value * np.array(vector) / (np.linalg.norm(vector) or 1)
            else:
                self.volume[kind] = self.over_time(line, value, "source" if kind == "source" else "body force")

    def concentrated(self, block):
        for name, nodes, line in self.groups(block):
            axis, points = line.number(1), self.faces.corners(nodes)
            force = tuple(float(k == axis) * line.number(2) for k in (1, 2, 3))
            faces = self.faces.between(points)
            if not any(force[: len(self.axes)]) or not nodes:
                self.leave(line, f"*CLOAD of '{name}'", "it is not a force along an axis of the mesh")
            elif faces and len({p for key in faces for p in key}) == len(points):
                self.act("force", name, line, faces, tuple(f * len(nodes) for f in force))
                self.notes.append(
                    (line.place, f"the force of {len(nodes)} nodes of '{name}' is distributed evenly over their faces")
                )
            elif len(self.point_loads) + len(nodes) <= MOST_FORCES and self.plane != "axisymmetric":
                self.point_loads += [
                    (f"{name}-{node}", self.mesh.deck.points[node], force, line) for node in sorted(nodes)
                ]
            else:
                self.leave(line, f"*CLOAD of '{name}'", "its nodes are not those of boundary faces")

    def uniform(self, block):
        """The temperature of all nodes. None if there are several."""
        found = [(line.number(1), self.faces.corners(nodes)) for _, nodes, line in self.groups(block)]
        if len({value for value, _ in found}) == 1 and len(set().union(*(p for _, p in found))) == len(
            self.mesh.point_of
        ):
            return self.degrees(found[0][0])
        self.leave(block, f"*{block.word}", f"it is not a single value for all nodes; {EXPRESSION}")

    def initial_conditions(self, block):
        if block.values.get("TYPE", "").upper() == "TEMPERATURE":
            self.initial = self.uniform(block)
        else:
            self.leave(block, f"*{block.word}", "only TYPE=TEMPERATURE is read")

    def body_temperature(self, block):
        self.temperature = self.uniform(block)

    def amplitude(self, block):
        flat = [real(cell, place) for place, cells in block.rows for cell in cells if cell]
        expect(flat and len(flat) % 2 == 0, f"{block.place}: *AMPLITUDE needs pairs of time and factor.")
        self.amplitudes[block.values.get("NAME", "").upper()] = flat[0::2], flat[1::2]

    def printed(self, block):
        """Nodes of a small set whose results are printed become probes."""
        name = block.values.get("NSET", "").rsplit(".", 1)[-1]
        nodes = self.faces.nodes(name) or ()
        if len(nodes) <= MOST_PROBES:
            self.probes.update({f"{name}-{node}": self.mesh.deck.points[node] for node in sorted(nodes)})

    def constants(self, block):
        if "ABSOLUTE ZERO" in block.values:
            self.absolute_zero = real(block.values["ABSOLUTE ZERO"], block.place)


HEAT = ("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT", "UNCOUPLED TEMPERATURE-DISPLACEMENT")
PROCEDURES = ("STATIC", "DYNAMIC", "FREQUENCY", "BUCKLE", *HEAT)
HANDLERS = {
    "MATERIAL": Physics.begin_material,
    "ELASTIC": Physics.elastic,
    "DENSITY": Physics.density,
    "EXPANSION": Physics.expansion,
    **dict.fromkeys(("CONDUCTIVITY", "SPECIFIC HEAT"), Physics.thermal),
    "PLASTIC": Physics.plastic,
    "SOLID SECTION": Physics.section,
    "STEP": Physics.begin_step,
    **dict.fromkeys(PROCEDURES, Physics.begin_procedure),
    "BOUNDARY": Physics.boundary,
    **dict.fromkeys(("DLOAD", "DSLOAD", "DFLUX", "DSFLUX", "FILM", "SFILM"), Physics.distributed),
    "CLOAD": Physics.concentrated,
    "TEMPERATURE": Physics.body_temperature,
    "INITIAL CONDITIONS": Physics.initial_conditions,
    "AMPLITUDE": Physics.amplitude,
    "PHYSICAL CONSTANTS": Physics.constants,
    **dict.fromkeys(("NODE PRINT", "NODE OUTPUT"), Physics.printed),
}
