# SPDX-License-Identifier: Apache-2.0
"""The wrong configurations of the thermocline: what table.py holds for the other programs."""


def cases(Case, run):
    def tank(name, message, *edits, **more):
        return Case(name, "thermocline", message, "tank", list(edits), **more)

    right = [tank("right tank", "", exit_code=0)]
    wrong = [
        tank("fluid that is not known", """
case.yaml:7:13: participants.tank.fluid.type: 'solar-slat' is not one of: solar-salt, caloria-ht43, air, custom. Did you mean 'solar-salt'?
""", ("type: solar-salt", "type: solar-slat")),
        tank("fluid of one's own with lists of different length", """
case.yaml:7:88: participants.tank.fluid.conductivity: has 1 values, 'temperature' has 2.
""", ("{type: solar-salt}", "{type: custom, density: 1800, specific-heat: 1500, temperature: [300, 600], conductivity: [0.5], viscosity: [1e-3, 1e-3]}")),
        tank("temperatures that do not grow", """
case.yaml:7:88: participants.tank.fluid.conductivity: 'temperature' must grow from value to value.
""", ("{type: solar-salt}", "{type: custom, density: 1800, specific-heat: 1500, temperature: [600, 300], conductivity: [0.5, 0.5], viscosity: [1e-3, 1e-3]}")),
        tank("step too long for the scheme", """
case.yaml:11:7: participants.tank.bed.courant: is at most 0.5 with advection: tvd, which is bounded only so far.
""", ("advection: tvd", "advection: tvd\n      courant: 0.8")),
        tank("bed without layers", """
case.yaml:8:5: participants.tank.bed.layers: needs one layer at least.
""", ("      layers:\n        - {height: 5 m, porosity: 0.22, diameter: 5 mm}\n", "")),
        tank("porosity in per cent without its sign", """
case.yaml:13:25: participants.tank.bed.layers[0].porosity: 22 is out of range; expected a value from 0.01 to 1.
""", ("porosity: 0.22", "porosity: 22")),
        tank("filler mechanics without a shell", """
case.yaml:14:5: participants.tank.filler-mechanics: presses on a shell; add one.
""", ("    shell:\n      material: {type: a387-grade-91}\n      plates:\n        - {height: 5 m, thickness: 20 mm}\n", ""),
             ("    insulation: {thickness: 0.3 m}\n", "")),
        tank("foundation of an unknown material", """
case.yaml:22:12: participants.tank.ground.layers[0].material: 'soils' is none of: concrete, dry-sand, foam-glass, hard-firebrick, insulating-concrete, insulating-firebrick, soil, steel-plate.
""", ("material: soil", "material: soils")),
        tank("rows of the schedule out of order", """
case.yaml:25:7: participants.tank.flow.rows: each row must come after the one before it.
""", ("390 degC}", "390 degC}\n        - {at: 0 h, mass-flow: 0}")),
        tank("flow without an inlet temperature", """
case.yaml:26:11: participants.tank.flow.rows[0].inlet-temperature: is missing; say how hot the fluid is that this flow brings.
""", (", inlet-temperature: 390 degC", "")),
        tank("profile with a height too many", """
case.yaml:12:7: participants.tank.bed.profile-temperature: needs as many values as profile-z.
""", ("initial-temperature: 290 degC", "profile-z: [0, 1, 2]\n      profile-temperature: [500, 600]")),
        tank("wall of another program that does not run", """
[tank 0] error: participants.tank.external-wall: nobody computes the wall in a run of the tank alone. Start it together with a coupler and a solid_solver, or remove this section.
""", ("    filler-mechanics: {}", "    filler-mechanics: {}\n    external-wall: {sections: 20}"), **run),
        tank("fewer cells than layers", """
[tank 0] error: bed: 1 cells are not enough for 2 layers; each layer needs one at least.
""", ("cells: 20", "cells: 1"), ("diameter: 5 mm}", "diameter: 5 mm}\n        - {height: 1 m, porosity: 0.4, diameter: 50 mm}"), **run),
    ]
    return right, wrong
