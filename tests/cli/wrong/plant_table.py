# SPDX-License-Identifier: Apache-2.0
"""Wrong tanks, plants and weather; joined by table.py."""


def weather(edit=lambda hour, line: line, head="hour,dni_W_m2,T_degC,wind_m_s,rh_pct,p_Pa", days=(151, 154)):
    """Some days of June as a CSV file."""
    text = head + "\n"
    for hour in range(24 * days[0], 24 * days[1]):
        sun = 800 if 7 <= hour % 24 <= 17 else 0
        text += edit(hour - 24 * days[0], f"{hour},{sun},20,2,50,99000\n")
    return {"weather.csv": text}


def cases(Case, run):
    """The right ones and the wrong ones."""
    def tank(name, message, *edits, **more):
        more.setdefault("files", weather())
        return Case(name, "thermocline", message, "plant", list(edits), **more)

    right = [
        tank("right plant", "", exit_code=0),
        tank("right plant that runs", "", exit_code=0, **run),
    ]
    wrong = [
        tank("hot below cold", """
case.yaml:23:7: participants.tank.flow.hot: 'hot' must be above 'cold'.
""", ("hot: 390 degC", "hot: 280 degC")),
        tank("temperature without its unit", """
case.yaml:23:7: participants.tank.flow.hot: '390' has no unit, but one is required: write 390 degC or 390 K.
case.yaml:24:7: participants.tank.flow.cold: '290' has no unit, but one is required: write 290 degC or 290 K.
""", ("hot: 390 degC", "hot: 390"), ("cold: 290 degC", "cold: 290")),
        tank("temperature in another unit than meant", """
case.yaml:17:5: participants.tank.flow: hot is 390 K, that is 116.9 degC, but solar salt is not a liquid below 238 degC; write '390 degC' if that is intended.
""", ("hot: 390 degC", "hot: 390 K"), ("cold: 290 degC", "cold: 290 K")),
        tank("a temperature where a difference is meant", """
case.yaml:25:7: participants.tank.flow.restart: '10 degC' is a temperature, but a temperature difference is expected: write 10 K (differences have the same value in K and degC).
""", ("cold: 290 degC", "cold: 290 degC\n      restart: 10 degC")),
        tank("cut-off wider than the plant's span", """
case.yaml:25:7: participants.tank.flow.cut-off: must be smaller than the difference between 'hot' and 'cold'.
""", ("cold: 290 degC", "cold: 290 degC\n      cut-off: 120 K")),
        tank("no such date", """
case.yaml:16:7: participants.tank.ambient.from: '06-31' is not a date: month 6 of a year of 365 days has 30 days.
""", ("from: 06-01", "from: 06-31")),
        tank("date in words", """
case.yaml:16:7: participants.tank.ambient.from: 'June' is not a date: expected month and day as MM-DD, for example 06-01.
""", ("from: 06-01", "from: June")),
        tank("report without a plant", """
case.yaml:19:5: participants.tank.report: requires a plant: set flow: {type: plant, ...} or remove it.
""", ("""      type: plant
      electric-power: 1 MW
      block-efficiency: 0.4
      field-area: 10000 m^2
      field-efficiency: 0.7
      hot: 390 degC
      cold: 290 degC
""", "      type: rest\n")),
        tank("costs without a price", """
case.yaml:25:29: participants.tank.report.economics: all prices are 0: the levelised cost is undefined.
""", ("{run-in: 0 day}", "{run-in: 0 day, economics: {interest: 0.05}}")),
        tank("plant key without a plant", """
case.yaml:19:7: participants.tank.flow.electric-power: this key is not valid here; it requires type: plant.
case.yaml:20:7: participants.tank.flow.block-efficiency: this key is not valid here; it requires type: plant.
case.yaml:21:7: participants.tank.flow.field-area: this key is not valid here; it requires type: plant.
case.yaml:22:7: participants.tank.flow.field-efficiency: this key is not valid here; it requires type: plant.
case.yaml:23:7: participants.tank.flow.hot: this key is not valid here; it requires type: plant.
case.yaml:24:7: participants.tank.flow.cold: this key is not valid here; it requires type: plant.
""", ("type: plant", "type: rest")),
        tank("latitude beyond the pole", """
case.yaml:15:7: participants.tank.ambient.latitude: 95 deg is out of range; expected a value from -90 deg to 90 deg.
""", ("type: file\n      file: weather.csv", "type: clear-sky\n      latitude: 95 deg")),
        tank("file of a clear sky", """
case.yaml:16:7: participants.tank.ambient.file: this key is not valid here; it requires type: file.
""", ("type: file", "type: clear-sky\n      latitude: 37 deg")),
        tank("weather file that is not there", """
[tank 0] error: wether.csv: this weather file does not exist. Relative paths start at the folder of the YAML file.
""", ("weather.csv", "wether.csv"), **run),
        tank("weather of another season", """
[tank 0] error: weather.csv: this file has no weather for 12-01; it covers 06-01 to 06-03.
""", ("from: 06-01", "from: 12-01"), **run),
        tank("weather with a column too few", """
[tank 0] error: weather.csv:1: the column 'p_Pa' is missing. A weather file has the columns dni_W_m2, T_degC, wind_m_s, rh_pct, p_Pa, hour.
""", files=weather(head="hour,dni_W_m2,T_degC,wind_m_s,rh_pct"), **run),
        tank("weather that is too hot", """
[tank 0] error: weather.csv:32: the air temperature [degC] is 200; it must be from -70 to 65.
""", files=weather(lambda h, line: line.replace(",20,", ",200,") if h == 30 else line), **run),
        tank("weather with a long gap", """
[tank 0] error: weather.csv:7: hours 3629 to 3638 of the year are missing. Gaps of more than 6 hours are not filled; complete the file or choose a period without the gap.
""", files=weather(lambda h, line: "" if 5 <= h < 15 else line), **run),
    ]
    return right, wrong
