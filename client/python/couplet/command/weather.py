# SPDX-License-Identifier: Apache-2.0
"""Converts a weather file to the CSV that a thermocline reads (docs/input-data.md): EnergyPlus (EPW), SAM or NSRDB,
TMY3, the typical year of PVGIS as CSV, and tables with other column names, units or separators. All of them may be
compressed (.gz). The format is recognized by the first lines. 29 February is dropped, several records per hour are
averaged, codes for missing values become gaps, and without humidity the dew point is used. PVGIS gives instantaneous
values in UTC, which become hourly means in the standard time of the longitude. The thermocline checks the ranges,
order and gaps of the result."""
import csv
import gzip
import math
import pathlib
import re
import shlex
import zlib

from couplet import files
from couplet.runs.case import Wrong, expect

NAN = math.nan
DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)  # per month of a reference year
# Written column: description, names in other formats, and their units as {unit: (factor, offset)}. The first unit is written.
QUANTITIES = {
    "dni_W_m2": (
        "direct normal irradiance",
        ("dni", "beam", "beam normal irradiance", "direct normal irradiance", "gb(n)"),
        {"w/m2": (1, 0), "wh/m2": (1, 0), "kw/m2": (1000, 0), "kwh/m2": (1000, 0), "mj/m2": (1e6 / 3600, 0)},
    ),
    "T_degC": (
        "air temperature",
        ("temperature", "tdry", "dry-bulb", "air temperature", "temp", "t2m"),
        {"degc": (1, 0), "c": (1, 0), "k": (1, -273.15), "f": (5 / 9, -160 / 9), "degf": (5 / 9, -160 / 9)},
    ),
    "wind_m_s": (
        "wind speed",
        ("wind speed", "wspd", "windspeed", "ws10m"),
        {"m/s": (1, 0), "km/h": (1 / 3.6, 0), "kn": (1852 / 3600, 0), "mph": (0.44704, 0)},
    ),
    "rh_pct": (
        "relative humidity",
        ("relative humidity", "rh", "rhum"),
        {"%": (1, 0), "percent": (1, 0), "1": (100, 0)},
    ),
    "p_Pa": (
        "pressure",
        ("pressure", "pres", "surface pressure", "sp"),
        {"pa": (1, 0), "mbar": (100, 0), "hpa": (100, 0), "kpa": (1000, 0), "bar": (1e5, 0)},
    ),
    "dew": ("dew point", ("dew point", "tdew", "dewpoint", "dew-point", "dew point temperature"), {}),
}
QUANTITIES["dew"] = (*QUANTITIES["dew"][:2], QUANTITIES["T_degC"][2])
WRITTEN = [name for name in QUANTITIES if name != "dew"]
MISSING_BELOW = -90  # codes such as -9999, in the unit of the file
# EnergyPlus: columns from 0 in the order of WRITTEN. Values from this one on mean "missing".
EPW = ((14, 9999), (6, 99.9), (21, 999), (8, 999), (9, 999999))
TIMES = (
    "month",
    "day",
    "hour",
    "minute",
    "date (mm/dd/yyyy)",
    "time (hh:mm)",
    "time(utc)",
    "time",
    "date",
    "datetime",
    "timestamp",
)


def declare(parser):
    parser.add_argument("file", type=pathlib.Path, metavar="FILE", help="weather file to convert")
    parser.add_argument(
        "-o",
        "--output",
        type=pathlib.Path,
        metavar="OUT.csv",
        help="CSV to write, compressed if its name ends in .gz (default: NAME_weather.csv next to FILE)",
    )


class Source:
    """Lines of a file, with errors that name it."""

    def __init__(self, file):
        expect(file.is_file(), f"{file}: this weather file does not exist.")
        data = file.read_bytes()
        if data[:2] == b"\x1f\x8b":
            try:
                data = gzip.decompress(data)
            except (EOFError, OSError, zlib.error) as error:
                raise Wrong(f"{file}: this file is damaged or truncated: {error}. Copy or compress it again.") from None
        expect(b"\0" not in data, f"{file}: this is not a text file.")
        self.file, self.lines = file, re.split(r"\r\n|\n|\r", data.decode("utf-8-sig", errors="replace").rstrip("\r\n"))
        # Rows of a table with decimal commas have at most as many commas as semicolons.
        self.separator = max(";,\t", key=lambda mark: max(line.count(mark) for line in self.lines[:100]))

    def cells(self, i):
        try:
            return [cell.strip() for cell in next(csv.reader(self.lines[i : i + 1], delimiter=self.separator), [])]
        except csv.Error as error:
            raise Wrong(f"{self.file}:{i + 1}: {error}.") from None

    def expect(self, condition, i, text):
        expect(condition, f"{self.file}:{i + 1}: {text}")

    def number(self, text, i, name):
        """Returns a finite number, or NaN for a gap."""
        text = text.strip()
        if text in ("", "nan", "NaN", "NA"):
            return NAN
        plain = text.replace(",", ".") if self.separator == ";" else text
        self.expect(
            re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", plain, re.A),
            i,
            f"'{text}' is not a number; expected the {name} here.",
        )
        return float(plain)

    def whole(self, text, i, name, low, high):
        value = self.number(text, i, name)
        self.expect(value == value // 1, i, f"the {name} must be a whole number, not '{text}'.")
        self.expect(low <= value <= high, i, f"the {name} is {value:g}; it must be from {low} to {high}.")
        return int(value)

    def width(self, cells, n, i):
        self.expect(len(cells) >= n, i, f"{len(cells)} values, but the file has {n} columns.")
        self.expect(
            not any(cells[n:]),
            i,
            f"{len(cells)} values, but the file has {n} columns. If commas are decimal commas, use decimal points.",
        )

    def site(self, latitude, longitude, zone, i):
        values = [
            self.number(text, i, name)
            for text, name in ((latitude, "latitude"), (longitude, "longitude"), (zone, "time zone"))
        ]
        self.expect(
            abs(values[0]) <= 90 and abs(values[1]) <= 180 and abs(values[2]) <= 14,
            i,
            "latitude {:g}, longitude {:g} and time zone {:g} are not a valid location.".format(*values),
        )
        return values


def hour_of_year(source, i, month, day, hour):
    """Hour of the year from 0, or None on 29 February, which a reference year does not have."""
    source.expect(
        1 <= month <= 12 and 1 <= day <= DAYS[month - 1] or (month, day) == (2, 29),
        i,
        f"'{month:02d}-{day:02d}' is not a date of a year of 365 days.",
    )
    return None if (month, day) == (2, 29) else 24 * (sum(DAYS[: month - 1]) + day - 1) + hour


def humidity_of(temperature, dew):
    """Relative humidity [%] by Magnus' formula; both temperatures in degC."""
    pressure = lambda t: math.exp(17.625 * t / (243.04 + t))
    return NAN if math.isnan(temperature + dew) else min(100.0, 100 * pressure(dew) / pressure(temperature))


class Head:
    """Columns of a table with their quantities and units."""

    def __init__(self, source, i, units):
        """`units` is {quantity: unit} for columns without a unit in their heading."""
        self.source, self.n, self.at, self.time = source, len(source.cells(i)), {}, {}
        for column, cell in enumerate(source.cells(i)):
            quantity, unit = quantity_of(cell)
            if quantity is None:
                if cell.lower() in TIMES:
                    self.time.setdefault(cell.lower(), column)
                continue
            if quantity in self.at and source.cells(i)[self.at[quantity][0]].lower() != cell.lower():
                continue  # another name of a quantity already found
            source.expect(quantity not in self.at, i, f"the column '{cell}' appears twice.")
            known, unit = QUANTITIES[quantity][2], unit or units.get(quantity)
            source.expect(
                unit, i, f"the unit of the column '{cell}' is missing; write for example '{cell} [{list(known)[1]}]'."
            )
            key = re.sub(r"[\s^°*]", "", unit.lower().replace("²", "2"))
            source.expect(key in known, i, f"the unit of '{cell}' is '{unit}'; supported: {', '.join(known)}.")
            self.at[quantity] = (column, *known[key])
        for name in WRITTEN:
            what, names, _ = QUANTITIES[name]
            names += QUANTITIES["dew"][1] if name == "rh_pct" else ()
            source.expect(
                name in self.at or name == "rh_pct" and "dew" in self.at,
                i,
                f"the column for the {what} is missing; it may be named {', '.join(names)}.",
            )

    def values(self, cells, i):
        self.source.width(cells, self.n, i)
        found = {}
        for name, (column, factor, offset) in self.at.items():
            value = self.source.number(cells[column], i, QUANTITIES[name][0])
            found[name] = NAN if value < MISSING_BELOW else value * factor + offset
        if "rh_pct" not in found:
            found["rh_pct"] = humidity_of(found["T_degC"], found["dew"])
        if -1 < found["dni_W_m2"] < 0:
            found["dni_W_m2"] = 0.0  # offsets of instruments
        return [found[name] for name in WRITTEN]


def quantity_of(cell):
    """Returns (quantity, unit) of a heading such as 'DNI (W/m^2)', 'Gb(n)' or 'T_degC'. (None, '') if unknown."""
    for name, (_, names, units) in QUANTITIES.items():
        if cell == name:
            return name, next(iter(units))
        if cell.lower() in names:
            return name, ""
        match = re.fullmatch(r"(.*?)\s*[\[(]([^\[(]*)[\])]", cell)
        if match and match[1].lower() in names:
            return name, match[2]
    return None, ""


def epw(source):
    for i in range(8, len(source.lines)):
        cells = source.cells(i)
        source.expect(len(cells) >= 22, i, f"{len(cells)} columns; an EPW record has 35.")
        source.width(cells, min(35, len(cells)), i)
        month, day = (source.whole(cells[c], i, name, 0, 99) for c, name in ((1, "month"), (2, "day")))
        hour = hour_of_year(source, i, month, day, source.whole(cells[3], i, "hour", 1, 24) - 1)
        values = [source.number(cells[column], i, QUANTITIES[name][0]) for name, (column, _) in zip(WRITTEN, EPW)]
        yield i, hour, source.whole(cells[4], i, "minute", 0, 60), [
            NAN if v >= missing else v for v, (_, missing) in zip(values, EPW)
        ]


def table(source, first, head):
    """Records below the head in line `first`: (line, hour of the year, minute, values)."""
    at, i = head.time, first
    for i in range(first + 1, len(source.lines)):
        cells = source.cells(i)
        if not source.lines[i].strip() or source.lines[i].startswith("#"):
            if "time(utc)" in at and not source.lines[i].strip():
                break  # the legend of PVGIS follows
            continue
        source.expect(len(cells) > max(at.values()), i, f"{len(cells)} values, but the file has {head.n} columns.")
        minute = 0
        if {"month", "day", "hour"} <= set(at):
            month, day, hour = (source.whole(cells[at[name]], i, name, 0, 99) for name in ("month", "day", "hour"))
            minute = source.whole(cells[at["minute"]], i, "minute", 0, 59) if "minute" in at else 0
        elif "time (hh:mm)" in at and "date (mm/dd/yyyy)" in at:
            date, clock = cells[at["date (mm/dd/yyyy)"]], cells[at["time (hh:mm)"]]
            match = re.fullmatch(r"(\d+)/(\d+)/\d+ (\d+):(\d+)", f"{date} {clock}", re.A)
            source.expect(match, i, f"'{date},{clock}' is not a date MM/DD/YYYY and time HH:MM.")
            month, day, hour = int(match[1]), int(match[2]), int(match[3]) - 1
            source.expect(
                0 <= hour < 24 and int(match[4]) == 0,
                i,
                f"the time is {clock}; a TMY3 file has full hours from 01:00 to 24:00.",
            )
        elif set(at) - {"hour"}:
            stamp = " ".join(cells[column] for name, column in at.items() if name != "hour")
            match = re.fullmatch(r"\d{4}-?(\d\d)-?(\d\d)[T :]+(\d\d):?(\d\d)(?::00)?Z?", stamp, re.A)
            source.expect(match, i, f"'{stamp}' is not a time such as 20090131:2300 or 2009-01-31 23:00.")
            month, day, hour, minute = map(int, match.groups())
            source.expect(minute < 60, i, f"the minute is {minute}; it must be from 0 to 59.")
        else:
            yield i, source.whole(cells[at["hour"]], i, "hour of the year", 0, 8759), 0, head.values(cells, i)
            continue
        source.expect(0 <= hour < 24, i, f"the hour is {hour}; it must be from 0 to 23.")
        yield i, hour_of_year(source, i, month, day, hour), minute, head.values(cells, i)
    for late in range(i, len(source.lines)) if "time(utc)" in at else ():
        source.expect(
            late == i or not re.match(r"\d{8}:\d{4},", source.lines[late]),
            late,
            f"a record after the empty line {i + 1}, which ends the records of a PVGIS file.",
        )


def hourly(source, records):
    """Returns [[hour, values]] averaged over the records of each hour, minutes of all records, and true if an hour has several."""
    hours, minutes, several = [], [], False
    for i, hour, minute, values in records:
        if hour is None:
            continue
        if hours and hours[-1][0] == hour:
            source.expect(
                minute > minutes[-1],
                i,
                (
                    f"minute {minute} of hour {hour} of the year comes after minute {minutes[-1]}: each record must"
                    " appear once, in order."
                ),
            )
            hours[-1][1].append(values)
            several = True
        else:
            hours.append([hour, [values]])
        minutes.append(minute)
    expect(hours, f"{source.file}: this weather file contains no hours.")
    return [[hour, [sum(column, 0.0) / len(rows) for column in zip(*rows)]] for hour, rows in hours], minutes, several


def behind(source, first, word, without=None):
    """Returns (line, text) of 'Latitude (decimal degrees): text' above the head of a PVGIS file."""
    for i in range(first):
        if source.lines[i].strip().startswith(word) and ":" in source.lines[i]:
            return i, source.lines[i].partition(":")[2]
    source.expect(
        without is not None, 0, f"the first lines of a PVGIS file must contain '{word} (decimal degrees): ...'."
    )
    return 0, without


def means_of_moments(hours, offset):
    """Hourly means of irradiance given `offset` hours after the full hour, with linear interpolation."""
    n, shift = len(hours), math.floor(offset)
    x = offset - shift
    at = lambda h: hours[(h - shift) % n][1][0]
    return [0.5 * x * x * at(h - 1) + (0.5 + x - x * x) * at(h) + 0.5 * (1 - x) * (1 - x) * at(h + 1) for h in range(n)]


def pvgis(source, first, head):
    """Converts instantaneous values in UTC to means on standard time: hours, location, seconds of the states after the full hour."""
    (line, latitude), (_, longitude) = behind(source, first, "Latitude"), behind(source, first, "Longitude")
    site = source.site(latitude, longitude, "0", line)
    offset = source.number(behind(source, first, "Irradiance Time Offset", "0")[1], 0, "irradiance time offset")
    source.expect(abs(offset) <= 1, 0, f"the irradiance time offset is {offset:g} h; expected -1 to 1.")
    records = list(table(source, first, head))
    for i, _, minute, _ in records:
        source.expect(
            minute == records[0][2], i, f"the minute is {minute}; all records of a PVGIS file must have the same."
        )
    hours, minutes, _ = hourly(source, records)
    expect(
        all(hour == hours[0][0] + k for k, (hour, _) in enumerate(hours)),
        f"{source.file}: hours are missing; a typical year of PVGIS has them all.",
    )
    for row, mean in zip(hours, means_of_moments(hours, minutes[0] / 60 + offset)):
        row[1][0] = mean
    zone = int(math.copysign(math.floor(abs(site[1]) / 15 + 0.5), site[1]))
    begin = hours[0][0]
    hours = [[begin + k, hours[(k - zone) % len(hours)][1]] for k in range(len(hours))]
    print(
        f"the times in {source.file.name} are UTC; those of the result are {zone:+d} h ahead, the standard time of its"
        " longitude"
    )
    return hours, [*site[:2], float(zone)], 60.0 * minutes[0]


def sam_units(source, first):
    """Returns {quantity: unit} and location from the two lines above a SAM or NSRDB head. Pressure is in mbar by default."""
    names, values = (source.cells(first - 2), source.cells(first - 1)) if first >= 2 else ([], [])
    about = {name.lower(): value for name, value in zip(names, values) if value}
    units = {"p_Pa": "mbar"}
    for quantity, key in (
        ("dni_W_m2", "dni units"),
        ("T_degC", "temperature units"),
        ("dew", "dew point units"),
        ("wind_m_s", "wind speed"),
        ("wind_m_s", "wind speed units"),
        ("rh_pct", "relative humidity units"),
        ("p_Pa", "pressure units"),
    ):
        if key in about:
            units[quantity] = about[key]
    place = [about.get(key) for key in ("latitude", "longitude", "time zone")]
    return units, source.site(*place, first - 1) if all(place) else None


def read(source):
    """Returns (format, hours, location or None, seconds of the states after the full hour)."""
    if source.lines[0].startswith("LOCATION,") or ".epw" in source.file.suffixes:
        source.expect(
            len(source.lines) > 8 and source.lines[0].startswith("LOCATION,"),
            0,
            "this is not an EPW file: it must start with a line LOCATION,... and have 8 header lines.",
        )
        place = source.cells(0)
        source.expect(len(place) >= 9, 0, "the line LOCATION must contain latitude, longitude and time zone.")
        hours, minutes, several = hourly(source, epw(source))
        return "EPW", hours, source.site(*place[6:9], 0), 60 * (sum(minutes) / len(minutes)) if several else 3600.0
    source.expect(".json" not in source.file.suffixes, 0, "JSON is not supported; request the same year as CSV or EPW.")
    known = lambda cell: cell.lower() in TIMES or quantity_of(cell)[0] is not None
    first = next((i for i in range(min(100, len(source.lines))) if sum(map(known, source.cells(i))) >= 2), None)
    source.expect(
        first is not None,
        0,
        (
            "this is not a known weather file: EPW, SAM or NSRDB, TMY3, the typical year of PVGIS, or a table with"
            " named columns."
        ),
    )
    usual = {name: next(iter(units)) for name, (_, _, units) in QUANTITIES.items() if name != "p_Pa"}
    times = {cell.lower() for cell in source.cells(first) if cell.lower() in TIMES}
    source.expect(
        times, first, "a time column is missing: month, day and hour, or time, or hour (of the year, from 0)."
    )
    if "time(utc)" in times:
        return ("PVGIS", *pvgis(source, first, Head(source, first, {**usual, "p_Pa": "pa"})))
    if {"date (mm/dd/yyyy)", "time (hh:mm)"} <= times:
        place = source.cells(0)
        source.expect(
            first > 0 and len(place) >= 7,
            0,
            (
                "the first line of a TMY3 file must contain number, name, state, time zone, latitude, longitude and"
                " elevation."
            ),
        )
        return (
            "TMY3",
            hourly(source, table(source, first, Head(source, first, usual)))[0],
            source.site(place[4], place[5], place[3], 0),
            3600.0,
        )
    sam = {"month", "day", "hour"} <= times
    units, site = sam_units(source, first) if sam else ({}, None)
    hours, minutes, several = hourly(source, table(source, first, Head(source, first, {**usual, **units})))
    stamped = times - {"month", "day", "hour"}  # a table without minutes refers to mid-hour
    return "SAM or NSRDB" if sam else "table", hours, site, 60.0 * minutes[-1] if stamped and not several else 1800.0


def text_of(value):
    return "nan" if math.isnan(value) else repr(value).removesuffix(".0")


def run(arguments):
    source = Source(arguments.file)
    kind, hours, site, states = read(source)
    stem = re.sub(r"(\.csv|\.epw)?(\.gz)?$", "", arguments.file.name, flags=re.I)
    output = arguments.output or arguments.file.with_name(stem + "_weather.csv")
    expect(not output.exists() or not output.samefile(arguments.file), f"-o: {output} is the file to be converted")
    lines = [f"# weather from {arguments.file.name} ({kind})"]
    lines += [f"# {name}: {text_of(value)}" for name, value in zip(("latitude", "longitude", "time-zone"), site or ())]
    lines += [f"# states-at: {text_of(states)}", ",".join(["hour", *WRITTEN])]
    lines += [",".join([str(hour), *map(text_of, values)]) for hour, values in hours]
    text = ("\n".join(lines) + "\n").encode()
    files.write(output.parent, output.name, gzip.compress(text) if output.suffix == ".gz" else text)
    print(
        f"{kind}: {len(hours)} hours written to {shlex.quote(str(output))}"
        + ("" if site else "; it has no location, so a run cannot compare its clock with the sun")
    )
    return 0
