# SPDX-License-Identifier: Apache-2.0
"""Case with the content of a deck."""
import numpy as np

from couplet.deck.patches import divide
from couplet.deck.physics import HEAT, PROCEDURES
from couplet.runs.case import expect

DENSITY = "7850 kg/m^3"  # of a material without one, where the answer does not depend on it
ANALYSES = {"DYNAMIC": "dynamic", "FREQUENCY": "modal", "BUCKLE": "buckling", "HEAT TRANSFER": "thermal"}


def vector(physics, terms, kind):
    return [physics.total([(c.block, value[i]) for c, value in terms], kind) for i in range(len(physics.axes))]


def patch_of(physics, acting, keys):
    """Mechanical condition of a patch."""
    held = {axis: text for c in acting if c.kind == "held" for axis, text in c.value.items()}
    loads = [c for c in acting if c.kind in ("pressure", "traction", "force")]
    normal, kinds, terms = physics.faces.normal(keys), {c.kind for c in loads}, []
    follows = normal is None or physics.procedure != "BUCKLE"  # the buckling load of CalculiX keeps its direction
    if any(c.kind == "axis" for c in acting):
        return {"type": "symmetry"}
    if len(held) == len(physics.axes):
        for c in loads:
            physics.leave(c.block, f"the {c.kind} on held faces of '{c.name}'", "it acts on the support only")
        return {"type": "fixed-displacement", "value": [held[axis] for axis in physics.axes]}
    if kinds == {"pressure"} and not held and follows:
        return {"type": "pressure", "value": physics.total([(c.block, c.value) for c in loads], "stress")}
    if kinds == {"force"} and not held and all(c.faces == keys for c in loads) and physics.plane != "axisymmetric":
        kind = "force per depth" if physics.plane else "force"
        return {
            "type": "force",
            "value": vector(physics, [(c, np.array(c.value) / physics.depth()) for c in loads], kind),
        }
    for c in loads:
        if c.kind == "pressure" and normal is None:
            physics.leave(c.block, f"the pressure on curved faces of '{c.name}'", "they also have another condition")
        elif c.kind == "pressure":
            if not follows:
                physics.notes.append((c.block.place, f"the pressure on '{c.name}' keeps its direction, as in CalculiX"))
            terms.append((c, -c.value * normal))
        else:
            area = physics.faces.area(c.faces) * physics.depth() if c.kind == "force" else 1
            terms.append((c, np.array(c.value) / area))
    traction = {"traction" if held else "value": vector(physics, terms, "stress")} if terms else {}
    if held:
        return {"type": "fixed-displacement", "components": held, **traction}
    return {"type": "traction" if terms else "free", **traction}


def material_of(physics, name, block, knows_heat):
    own = physics.materials.get(name)
    expect(own, f"{block.place}: there is no *MATERIAL, NAME={name}.")
    has_mass = physics.procedure == "DYNAMIC" or physics.is_transient or physics.gravity.any()
    if "density" not in own:
        is_free = not has_mass and (not physics.modes or physics.procedure == "BUCKLE")
        expect(is_free, f"{block.place}: the *MATERIAL '{own['name']}' needs *DENSITY for this step.")
        physics.notes.append(
            (block.place, f"'{own['name']}' has no *DENSITY; {DENSITY} is written, which has no effect here")
        )
    keys = {"density": own.get("density", DENSITY)}
    if physics.procedure != "HEAT TRANSFER":
        expect("elastic" in own, f"{block.place}: the *MATERIAL '{own['name']}' has no *ELASTIC of TYPE=ISO.")
        moduli, ratios, at = own["elastic"]
        keys.update({"youngs-modulus": moduli[0], "poissons-ratio": ratios[0]})
        if len(at) > 1 and knows_heat:
            keys["youngs-modulus-table"] = physics.table(moduli, at)
            keys["poissons-ratio-table"] = physics.table(ratios, at)
        elif len(at) > 1:
            physics.leave(block, f"*ELASTIC of '{own['name']}' beyond its first line", "no temperature is known")
        if physics.is_large:
            keys["law"] = "saint-venant-kirchhoff"
    return keys | {k: own[k] for k in ("conductivity", "specific-heat", "expansion", "yield-strength") if k in own}


def heat_of(physics, patches):
    heat = {"analysis": "transient" if physics.is_transient else "steady", "boundaries": {}}
    if physics.is_transient:
        heat["initial-temperature"] = physics.initial or physics.degrees(0.0)
    if "source" in physics.volume:
        heat["source"] = physics.volume["source"]
    for patch, (acting, _) in patches.items():
        for c in (c for c in acting if c.kind in ("temperature", "convection", "flux")):
            if patch in heat["boundaries"]:
                physics.leave(c.block, f"the {c.kind} of '{c.name}' on '{patch}'", "it has another thermal condition")
            heat["boundaries"].setdefault(patch, {"type": c.kind, **c.value})
    return heat


def materials_of(physics, knows_heat):
    used, zones = set(physics.mesh.zone_of), {}
    for (block, material, _), section in zip(physics.sections, physics.mesh.deck.sections):
        if section.name in used:
            zones.setdefault(material, (block, []))[1].append(section.name)
    lost = sorted(used - {zone for _, own in zones.values() for zone in own})
    expect(not lost, f"{physics.name}: elements of {', '.join(lost)} have no *SOLID SECTION.")
    found = {
        physics.materials.get(m, {}).get("name"): (own, material_of(physics, m, b, knows_heat))
        for m, (b, own) in zones.items()
    }
    if len(found) == 1:
        return {"material": keys for _, keys in found.values()}
    return {"materials": {name: {"zones": own, **keys} for name, (own, keys) in found.items()}}


def case_of(physics, name, mesh_file):
    """Returns the case. `mesh_file` tells its mesh, given whether the deck itself has the patches."""
    known = ", ".join(f"*{word}" for word in PROCEDURES)
    expect(
        physics.procedure,
        (
            f"{physics.name}: there is nothing to run: no *STEP contains one of {known}. The deck can still serve as"
            " the mesh of a case of your own (docs/how-to/own-mesh.md)."
        ),
    )
    is_hot, moves = physics.procedure in HEAT, physics.procedure != "HEAT TRANSFER"
    if physics.plane == "axisymmetric":
        x = np.abs(physics.faces.points[:, 0])
        on_axis = {key for key in physics.faces.keys if x[list(key)].max() < 1e-9 * x.max()}
        physics.act("axis", "axis", physics.step, on_axis, {})
    patches, is_own = divide(physics.faces, physics.conditions)
    solid = {"program": "solid_solver", "mesh": mesh_file(is_own)}
    solid |= {"mesh-scale": physics.system[0]} if physics.system[0] != 1 else {}
    solid |= {"dimension": len(physics.axes), **({"plane": physics.plane} if physics.plane else {})}
    solid["analysis"] = ANALYSES.get(physics.procedure, "static")
    if physics.is_large:
        solid["kinematics"] = "finite-strain"
    solid |= materials_of(physics, is_hot or physics.temperature)
    if moves:
        solid["boundaries"] = {patch: patch_of(physics, *patches[patch]) for patch in physics.mesh.patches}
        if physics.gravity.any():
            solid["gravity"] = [physics.si(g, "acceleration") for _, g in zip(physics.axes, physics.gravity)]
        if set(physics.axes) & physics.volume.keys():
            solid["body-force"] = [physics.volume.get(axis, "0 N/m^3") for axis in physics.axes]
    place_of = lambda x: [physics.si(value, "length") for _, value in zip(physics.axes, x)]
    for i, (point, place, force, line) in enumerate(physics.point_loads, 1):
        values = [
            physics.over_time(line, f / physics.depth(), "force per depth" if physics.plane else "force") for f in force
        ]
        load = {"point": place_of(place), "force": values[: len(physics.axes)]}
        solid.setdefault("point-loads", {})[f"{point}-{i}"] = load
    if is_hot:
        solid["heat"] = heat_of(physics, patches)
    elif physics.temperature:
        solid["temperature"] = physics.temperature
    if moves and (is_hot or physics.temperature) and any("expansion" in own for own in physics.materials.values()):
        solid["thermal-expansion"] = {"reference-temperature": physics.initial or physics.degrees(0.0)}
    fields = ["displacement"] * moves + ["temperature"] * is_hot
    if physics.probes and solid["analysis"] != "modal":
        solid["probes"] = {
            probe: {"point": place_of(place), "fields": fields} for probe, place in physics.probes.items()
        }
    if physics.modes:
        solid["output"] = {"buckling" if physics.procedure == "BUCKLE" else "modes": physics.modes}
    simulation = {"name": name, "end-time": f"{physics.end:.10g} s", "time-step": f"{physics.dt:.10g} s"}
    return (
        with_degrees({"simulation": simulation, "participants": {"solid": solid}}, unit_of_temperature(physics)),
        is_own,
    )


def unit_of_temperature(physics):
    """The unit by the absolute zero of the deck. Without one, temperatures below 70 are no usual ones in K."""
    low, zero = min(physics.temperatures, default=0), physics.absolute_zero
    unit = "K" if zero == 0 or zero is None and low >= 70 else "degC"
    if physics.temperatures and zero not in (0, -273.15):
        how = "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15 (degC) or 0 (K) would determine it"
        physics.notes.append(
            (physics.name, f"temperatures are taken to be in {unit}, because the lowest is {low:g}; {how}")
        )
    return unit


def with_degrees(node, unit):
    if isinstance(node, dict) and "degrees" not in node:
        return {key: with_degrees(value, unit) for key, value in node.items()}
    if isinstance(node, dict):
        return f"{node['degrees']:.10g} {unit}"
    return [with_degrees(value, unit) for value in node] if isinstance(node, list) else node
