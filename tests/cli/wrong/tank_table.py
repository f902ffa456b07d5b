# SPDX-License-Identifier: Apache-2.0
"""The wrong configurations of the thermocline: what table.py holds for the other programs."""


def cases(Case, run):
    def tank(name, message, *edits, **more):
        return Case(name, "thermocline", message, "tank", list(edits), **more)

    rows = """    flow:
      type: schedule
      rows:
        - {at: 0 h, mass-flow: -20 kg/s, inlet-temperature: 390 degC}
"""
    weather = ("    flow:\n", "    ambient: {type: file, file: year.csv}\n    flow:\n")
    plant = """    flow:
      type: plant
      electric-power: 50 MW
      block-efficiency: 0.38
      field-area: 510120 m^2
      field-efficiency: 0.70
      hot: 390 degC
      cold: 290 degC
"""
    head = "hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa\n"
    day = "".join(f"{h},0,20,1,50,101325\n" for h in range(24))
    from_file = (rows, "    flow: {type: schedule, file: flows.csv}\n")
    flows = "time [h],mass-flow [kg/s],inlet-temperature [degC]\n0,-20,390\n1,20,290\n"

    def with_plant(more):
        return (rows, plant + more)

    right = [
        tank("right tank", "", exit_code=0),
        tank("--check: weather that is whole", "", weather, files={"year.csv": head + day}, exit_code=0),
        tank("--check: flows from a file", "", from_file, files={"flows.csv": flows}, exit_code=0),
        tank("load and tariff by a calendar", "", with_plant("""      tariff: [50]
      first-weekday: monday
      calendar:
        - {days: [weekend], load: [0.5], tariff: [30]}
        - {from: 11-01, to: 02-28, load: [0.8]}
    ambient: {type: clear-sky, latitude: 37 deg}
"""), exit_code=0),
    ]
    wrong = [
        tank("--check: no such weather", """
case.yaml:23:27: participants.tank.ambient.file: the file 'year.csv' does not exist.
""", weather),
        tank("--check: broken weather", """
case.yaml:23:27: participants.tank.ambient.file: year.csv:6: 'cold' is not a number; expected air temperature [degC] here.
""",
             weather, files={"year.csv": head + day.replace("4,0,20,", "4,0,cold,", 1)}),
        tank("--check: weather without the day on which the run starts", """
case.yaml:23:27: participants.tank.ambient.file: year.csv: this file has no weather for 05-01; it covers 01-01 to 01-01.
""",
             ("    flow:\n", "    ambient: {type: file, file: year.csv, from: 05-01}\n    flow:\n"), files={"year.csv": head + day}),
        tank("--check: air of smooth days", """
case.yaml:23:122: participants.tank.ambient.air: air.csv: this weather file does not exist. Relative paths start at the folder of the YAML file.
""",
             ("    flow:\n", "    ambient: {type: smooth-days, latitude: 37, daily-sums: [1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, 1e7, "
                             "1e7, 1e7, 1e7, 1e7], air: air.csv}\n    flow:\n")),
        tank("--check: sun of a file that does not say where it is", """
case.yaml:19:36: participants.tank.insulation.solar-absorptance: solar heating of the cover needs the sun's height, but year.csv does not specify the location. Add 'site: {latitude, longitude, time-zone}' to the section 'ambient', or leave solar-absorptance at 0.
""", weather,
             ("thickness: 0.3 m", "thickness: 0.3 m, solar-absorptance: 0.5"), files={"year.csv": head + day}),
        tank("--check: no such flow file", """
case.yaml:23:28: participants.tank.flow.file: the file 'flows.csv' does not exist.
""", from_file),
        tank("--check: broken flow file", """
case.yaml:23:28: participants.tank.flow.file: flows.csv:4: 'x' is not a number; expected mass-flow here.
""", from_file, files={"flows.csv": flows + "2,x,390\n"}),
        tank("--check: flows of frozen salt", """
case.yaml:23:28: participants.tank.flow.file: flows.csv: rows[0].inlet-temperature is 390 K, that is 116.9 degC, but solar salt is not a liquid below 238 degC; write '390 degC' if that is intended: here, in the column header.
""", from_file, files={"flows.csv": flows.replace("[degC]", "[K]")}),
        tank("rows and a file of rows", """
case.yaml:26:7: participants.tank.flow.rows: are given together with a 'file' of rows; remove one of them.
""", ("type: schedule\n", "type: schedule\n      file: flows.csv\n")),
        tank("a weekday that is none", """
case.yaml:31:7: participants.tank.flow.first-weekday: 'sonntag' is not a weekday: expected monday, tuesday, ... sunday.
""", with_plant("""      first-weekday: sonntag
      calendar:
        - {days: [weekend], load: [0.5]}
""")),
        tank("weekdays without a first one", """
case.yaml:23:5: participants.tank.flow.first-weekday: is missing: the rules of 'calendar' name weekdays; specify the weekday of the first day.
""", with_plant("""      calendar:
        - {days: [weekend], load: [0.5]}
""")),
        tank("rule of a calendar: a day that is none", """
case.yaml:33:12: participants.tank.flow.calendar[0].days: 'week-end' is not one of: monday, tuesday, wednesday, thursday, friday, saturday, sunday, weekdays, weekend.
""", with_plant("""      first-weekday: monday
      calendar:
        - {days: [week-end], load: [0.5]}
""")),
        tank("rule of a calendar: half a season", """
case.yaml:32:12: participants.tank.flow.calendar[0].from: a season needs 'from' and 'to'; 'to' is missing.
""", with_plant("""      calendar:
        - {from: 11-01, load: [0.5]}
""")),
        tank("rule of a calendar: no such date", """
case.yaml:32:12: participants.tank.flow.calendar[0].from: '02-30' is not a date: month 2 of a year of 365 days has 28 days.
""", with_plant("""      calendar:
        - {from: 11-01, to: 02-30, load: [0.5]}
""")),
        tank("rule of a calendar that gives nothing", """
case.yaml:32:11: participants.tank.flow.calendar[0]: a rule needs a load or a tariff.
""", with_plant("""      calendar:
        - {from: 11-01, to: 02-28}
""")),
        tank("rule of a calendar: seven loads", """
case.yaml:32:12: participants.tank.flow.calendar[0].load: has 7 values; give one, or 24 for the hours of the day from 00:00 on.
""", with_plant("""      calendar:
        - {load: [0, 0, 0, 0, 0, 1, 1]}
""")),
        tank("season of a calendar without dates", """
case.yaml:23:5: participants.tank.flow: calendar[0] has a season of weather dates, but the weather is constant; add 'ambient' with dates, or remove 'from' and 'to'.
""", with_plant("""      calendar:
        - {from: 11-01, to: 02-28, load: [0.8]}
""")),
        tank("prices of a calendar alone", """
case.yaml:23:5: participants.tank.flow.tariff: is needed for the hours without a price in any rule of 'calendar'.
""", with_plant("""      calendar:
        - {from: 11-01, to: 02-28, tariff: [60]}
""")),
        tank("fluid that is not known", """
case.yaml:7:13: participants.tank.fluid.type: 'solar-slat' is not one of: solar-salt, caloria-ht43, air, custom. Did you mean 'solar-salt'?
""", ("type: solar-salt", "type: solar-slat")),
        tank("fluid of one's own with lists of different length", """
case.yaml:7:92: participants.tank.fluid.conductivity: has 1 values, 'temperature' has 2.
""", ("{type: solar-salt}", "{type: custom, density: 1800, specific-heat: 1500, temperature: [300 K, 600 K], conductivity: [0.5], viscosity: [1e-3, 1e-3]}")),
        tank("temperatures that do not grow", """
case.yaml:7:92: participants.tank.fluid.conductivity: 'temperature' must increase from value to value.
""", ("{type: solar-salt}", "{type: custom, density: 1800, specific-heat: 1500, temperature: [600 K, 300 K], conductivity: [0.5, 0.5], viscosity: [1e-3, 1e-3]}")),
        tank("step too long for the scheme", """
case.yaml:11:7: participants.tank.bed.courant: is at most 0.5 with advection: tvd, the limit for boundedness.
""", ("advection: tvd", "advection: tvd\n      courant: 0.8")),
        tank("bed without layers", """
case.yaml:8:5: participants.tank.bed.layers: at least one layer is needed.
""", ("      layers:\n        - {height: 5 m, porosity: 0.22, diameter: 5 mm}\n", "")),
        tank("porosity in per cent without its sign", """
case.yaml:13:25: participants.tank.bed.layers[0].porosity: 22 is out of range; expected a value from 0.01 to 1.
""", ("porosity: 0.22", "porosity: 22")),
        tank("capsules in a layer of fluid alone", """
case.yaml:13:54: participants.tank.bed.layers[0].melting: a layer of fluid only (porosity 1) has no capsules that could melt.
""", ("advection: tvd", "advection: upwind"), ("porosity: 0.22, diameter: 5 mm", "porosity: 1, diameter: 5 mm, melting: {temperature: 340 degC, latent-heat: 100 kJ/kg}")),
        tank("flow in another unit than its own", """
[tank 0] error: flow: -2e+09 kg/s crosses a bed cell so fast that 600 s would need 3e+08 sub-steps (at most 1e+06). Is the unit of the flow correct? 'bed.advection: implicit' supports any step.
""", ("-20 kg/s", "-2e9 kg/s"), **{**run, "exit_code": 1}),
        tank("filler mechanics without a shell", """
case.yaml:14:5: participants.tank.filler-mechanics: requires a shell; add one.
""", ("    shell:\n      material: {type: a387-grade-91}\n      plates:\n        - {height: 5 m, thickness: 20 mm}\n", ""),
             ("    insulation: {thickness: 0.3 m}\n", "")),
        tank("foundation of an unknown material", """
case.yaml:22:12: participants.tank.ground.layers[0].material: 'soils' is not one of: concrete, dry-sand, foam-glass, hard-firebrick, insulating-concrete, insulating-firebrick, soil, steel-plate.
""", ("material: soil", "material: soils")),
        tank("rows of the schedule out of order", """
case.yaml:25:7: participants.tank.flow.rows: each row must come after the one before it.
""", ("390 degC}", "390 degC}\n        - {at: 0 h, mass-flow: 0}")),
        tank("flow without an inlet temperature", """
case.yaml:26:11: participants.tank.flow.rows[0].inlet-temperature: is missing; specify the temperature of this inflow.
""", (", inlet-temperature: 390 degC", "")),
        tank("profile with a height too many", """
case.yaml:12:7: participants.tank.bed.profile-temperature: needs as many values as profile-z.
""", ("initial-temperature: 290 degC", "profile-z: [0, 1, 2]\n      profile-temperature: [500 K, 600 K]")),
        tank("wall of another program that does not run", """
[tank 0] error: participants.tank.external-wall: no participant computes the wall in a run of the tank alone. Start it together with a coupler and a solid_solver, or remove this section.
""", ("    filler-mechanics: {}", "    filler-mechanics: {}\n    external-wall: {sections: 20}"), **run),
        tank("fewer cells than layers", """
[tank 0] error: bed: 1 cells are not enough for 2 layers; each layer needs at least one.
""", ("cells: 20", "cells: 1"), ("diameter: 5 mm}", "diameter: 5 mm}\n        - {height: 1 m, porosity: 0.4, diameter: 50 mm}"), **run),
    ]
    return right, wrong
