#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""couplet weather: files as NREL and the JRC write them become the CSV of a thermocline, with the right values, and wrong files are
reported with their line. The program names the command for a file of another format and reads what it wrote. Usage: run.py BIN"""
import argparse
import contextlib
import gzip
import io
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python")]
from couplet.command import dispatch, weather  # noqa: E402
from couplet.runs.case import Wrong  # noqa: E402

BIN = pathlib.Path(sys.argv.pop(1)).resolve()
HEADS = {
    "nsrdb": "Source,Location ID,City,State,Country,Latitude,Longitude,Time Zone,Elevation,Local Time Zone,Dew Point Units,DHI Units,DNI Units,GHI Units,"
             "Temperature Units,Pressure Units,Wind Direction Units,Wind Speed,Version\n"
             "NSRDB,145809,-,-,-,40.01,-105.26,-7,1628,-7,c,w/m2,w/m2,w/m2,c,mbar,Degrees,m/s,v3.0.6\n"
             "Year,Month,Day,Hour,Minute,Temperature,Dew Point,DHI,DNI,GHI,Surface Albedo,Pressure,Wind Direction,Wind Speed\n",
    "tmy3": '723170,"GREENSBORO, PIEDMONT TRIAD INT",NC,-5.0,36.100,-79.950,273\n'
            "Date (MM/DD/YYYY),Time (HH:MM),ETR (W/m^2),ETRN (W/m^2),GHI (W/m^2),GHI source,GHI uncert (%),DNI (W/m^2),DNI source,DNI uncert (%),"
            "Dry-bulb (C),Dry-bulb source,RHum (%),RHum source,Pressure (mbar),Pressure source,Wspd (m/s),Wspd source\n",
    "pvgis": "Latitude (decimal degrees): 45.000\nLongitude (decimal degrees): 8.000\nElevation (m): 250.0\nmonth,year\n"
             + "".join(f"{m},{2004 + m}\n" for m in range(1, 13)) + "time(UTC),T2m,RH,G(h),Gb(n),Gd(h),IR(h),WS10m,WD10m,SP\n",
    "epw": "LOCATION,Sevilla,-,ESP,SWEC,083910,37.00,-5.25,0,31.0\n" + "COMMENTS\n" * 7,
}
LEGEND = "\nT2m: 2-m air temperature (degree Celsius)\nRH: relative humidity (%)\n"


def same(_, line):
    return line


def nsrdb(edit=same, head=HEADS["nsrdb"]):
    """Two days; line 4 is hour 0."""
    row = "2003,1,{},{},30,{},-6,30,{},100,0.866,840,298.6,0.5\n"
    return head + "".join(edit(h, row.format(1 + h // 24, h % 24, h % 24 - 5, 960 if h % 24 == 12 else 0)) for h in range(48))


def tmy3(edit=same):
    """Two days; line 3 is the hour that ends at 01:00."""
    row = "01/{:02d}/1988,{:02d}:00,0,0,0,1,0,{},1,0,{},A,77,A,993,A,6.2,A\n"
    return HEADS["tmy3"] + "".join(edit(h, row.format(1 + h // 24, h % 24 + 1, 426 if h % 24 == 11 else 0, h % 24)) for h in range(48))


def pvgis(edit=same, more="", longitude="8.000"):
    """Two days; line 18 is 00:00 UTC."""
    row = "200901{:02d}:{:02d}00,{},91.95,0.0,{},0.0,322.99,2.3,334.0,99573.0\n"
    head = HEADS["pvgis"].replace("8.000", longitude).replace("month,year", more + "month,year")
    return head + "".join(edit(h, row.format(1 + h // 24, h % 24, h % 24, {10: "600.0", 11: "800.0"}.get(h % 24, "-0.0"))) for h in range(48)) + LEGEND


def epw(edit=same, records=1):
    """A day in March; line 9 is the hour that ends at 01:00."""
    row = "2005,3,1,{},{},source,{}.5,5,40,99000,0,0,300,0,{},0,0,0,0,0,180,2.5,0,0,9,9,9,9,0,0,0,0,0,0,0\n"
    return HEADS["epw"] + "".join(edit(h, row.format(h, 60 * r // records, h, 500 * r if 6 < h < 19 else 0)) for h in range(1, 25) for r in range(1, records + 1))


class Converted:
    """What the CSV says: numbers of its comments, and columns by name."""

    def __init__(self, text):
        comments = [line[1:].partition(":") for line in text.splitlines() if line.startswith("#")]
        self.about = {name.strip(): float(value) for name, colon, value in comments if colon}
        rows = [line.split(",") for line in text.splitlines() if not line.startswith("#")]
        self.columns = {name: [float(row[c]) for row in rows[1:]] for c, name in enumerate(rows[0])}

    def __getattr__(self, name):
        return self.columns[name]


class Formats(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="couplet-weather-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def convert(self, text, name="weather.csv", output="out.csv"):
        file = self.folder / name
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
        with contextlib.redirect_stdout(io.StringIO()) as self.said:
            weather.run(argparse.Namespace(file=file, output=self.folder / output))
        return Converted((self.folder / output).read_text())

    def refuse(self, text, words, name="weather.csv"):
        with self.assertRaises(Wrong) as caught:
            self.convert(text, name)
        self.assertIn(words, str(caught.exception).replace(f"{self.folder}/", ""))

    def test_nsrdb_has_site_units_and_dew_point(self):
        w = self.convert(nsrdb())
        self.assertEqual(w.about, {"latitude": 40.01, "longitude": -105.26, "time-zone": -7, "states-at": 1800})
        self.assertEqual((w.hour[47], w.dni_W_m2[12], w.T_degC[3], w.p_Pa[0], w.wind_m_s[0]), (47, 960, -2, 84000, 0.5))
        for hour, t in ((12, 7), (0, -5)):  # Magnus
            self.assertAlmostEqual(w.rh_pct[hour], 100 * math.exp(17.625 * -6 / 237.04) / math.exp(17.625 * t / (243.04 + t)), 9)
        self.assertEqual(self.convert(nsrdb(head=HEADS["nsrdb"].replace(",mbar,", ",hPa,"))).p_Pa[0], 84000)

    def test_records_of_an_hour_are_averaged_and_none_may_appear_twice(self):
        def half(h, line):
            return f"2003,1,{1 + h // 24},{h % 24},0,{h % 24 - 7},-6,30,{800 if h % 24 == 12 else 0},100,0.866,820,298.6,1.5\n" + line
        w = self.convert(nsrdb(half))
        self.assertEqual((len(w.hour), w.dni_W_m2[12], w.p_Pa[0], w.T_degC[12], w.about["states-at"]), (48, 880, 83000, 6, 1800))
        self.refuse(nsrdb(lambda h, line: line + line if h == 12 else line), "weather.csv:17: minute 30 of hour 12 of the year comes after minute 30")

    def test_sam_names_and_a_leap_day_are_known(self):
        rows = "".join(f"2004,{day},{h},0,{700 if h == 12 else 0},10,5,1,70,990,3,180,0.2\n" for day in ("2,28", "2,29", "3,1") for h in range(24))
        w = self.convert("Latitude,Longitude,Time Zone,Elevation\n33.2,-97.1,-6,190\nYear,Month,Day,Hour,GHI,DNI,DHI,Tdry,Tdew,RH,Pres,Wspd,Wdir,Albedo\n" + rows)
        self.assertEqual((len(w.hour), w.hour[0], w.hour[24], w.rh_pct[0], w.p_Pa[0], w.about["latitude"]), (48, 58 * 24, 59 * 24, 70, 99000, 33.2))

    def test_codes_for_missing_values_become_gaps(self):
        w = self.convert(nsrdb(lambda h, line: "2003,1,1,5,30,-9999,-6,30,0,100,0.866,840,298.6,0.5\n" if h == 5 else "" if h == 7 else line))
        self.assertTrue(math.isnan(w.T_degC[5]) and math.isnan(w.rh_pct[5]) and 7 not in w.hour)
        self.assertTrue(math.isnan(self.convert(epw(lambda h, line: line.replace(",9.5,", ",99.9,")), "code.epw").T_degC[8]))
        self.assertTrue(math.isnan(self.convert(tmy3(lambda h, line: line.replace("05:00,0,0,0,1,0,0", "05:00,0,0,0,1,0,-9900"))).dni_W_m2[4]))

    def test_wrong_nsrdb_files_are_reported_with_their_line(self):
        def third(row):
            return nsrdb(lambda h, line: row + "\n" if h == 3 else line)
        good = "2003,1,1,3,30,1,-6,30,0,1,0.8,840,298,0.5"
        for row, words in ((good.replace(",30,1,", ",60,1,"), "the minute is 60"), (good.replace("1,-6", "warm,-6"), "'warm' is not a number"),
                           ("2003,1,1,3", "4 values, but the file has 14 columns"), (good.replace("2003,1,", "2003,13,"), "'13-01' is not a date"),
                           (good.replace(",3,30", ",24,30"), "the hour is 24"), (good + ",5", "15 values, but the file has 14 columns. If commas"),
                           (good.replace(",3,30", ",3.5,30"), "the hour must be a whole number, not '3.5'"), (good.replace("840", "1e999x"), "'1e999x' is not a number")):
            self.refuse(third(row), f"weather.csv:7: {words}")
        self.refuse(nsrdb(head=HEADS["nsrdb"].replace(",GHI,Surface", ",DNI,Surface")), "weather.csv:3: the column 'DNI' appears twice")
        self.refuse(nsrdb(head=HEADS["nsrdb"].replace(",mbar,", ",psi,")), "weather.csv:3: the unit of 'Pressure' is 'psi'; supported: pa, mbar, hpa")
        self.refuse(nsrdb(head=HEADS["nsrdb"].replace("40.01", "140")), "weather.csv:2: latitude 140")
        self.refuse(nsrdb(head=HEADS["nsrdb"].replace(",DHI,DNI", ",DHI,GTI")), "weather.csv:3: the column for the direct normal irradiance is missing")
        self.refuse(nsrdb().encode() + b"\0", "weather.csv: this is not a text file")
        self.refuse("Source,Latitude,Longitude,Time Zone\nNSRDB,40,-105,-7\n", "weather.csv:1: this is not a known weather file")

    def test_tmy3_has_hours_that_end(self):
        w = self.convert(tmy3(), "723170TYA.CSV")
        self.assertEqual(w.about, {"latitude": 36.1, "longitude": -79.95, "time-zone": -5, "states-at": 3600})
        self.assertEqual((w.hour[0], w.dni_W_m2[11], w.p_Pa[0], w.rh_pct[0]), (0, 426, 99300, 77))
        for row, words in (("01/01/1988,05:30,0,0,0,1,0,0,1,0,1,A,77,A,993,A,6.2,A", "the time is 05:30"),
                           ("1988-01-01,05:00,0,0,0,1,0,0,1,0,1,A,77,A,993,A,6.2,A", "'1988-01-01,05:00' is not a date"), ("01/01/1988,05:00", "2 values")):
            self.refuse(tmy3(lambda h, line, row=row: row + "\n" if h == 4 else line), f"weather.csv:7: {words}")
        self.refuse("1,2\n" + tmy3().partition("\n")[2], "weather.csv:1: the first line of a TMY3 file")

    def test_pvgis_gives_moments_in_utc(self):
        w = self.convert(pvgis())
        self.assertEqual(w.about, {"latitude": 45, "longitude": 8, "time-zone": 1, "states-at": 0})
        self.assertEqual(w.dni_W_m2[10:14], [300, 700, 400, 0], "10 UTC is 11 local standard time")
        self.assertEqual((w.T_degC[1], w.p_Pa[0], w.rh_pct[0], len(w.hour)), (0, 99573, 91.95, 48))
        self.assertIn("are UTC; those of the result are +1 h ahead", self.said.getvalue())
        east = self.convert(pvgis(longitude="135.0"))
        self.assertEqual((max(range(24), key=east.dni_W_m2.__getitem__), east.about["time-zone"]), (19, 9))
        self.refuse("Latitude (decimal degrees):\t45\nLongitude (decimal degrees):\t8\n\ntime,G(i),H_sun,T2m\n20050101:0010,0,0,1\n", "the column for the direct")
        self.refuse("{}", "year.json:1: JSON is not supported", "year.json")

    def test_pvgis_irradiance_belongs_to_its_own_moment(self):
        def stamped(minute):
            return lambda h, line: line[:11] + minute + line[13:]
        half = self.convert(pvgis(more="Irradiance Time Offset (h): 0.5\n"))
        # 600 at 10:30, 800 at 11:30, 0 at 9:30 and 12:30: (0 + 6 * 600 + 800)/8 from 10 to 11 UTC.
        for hour, value in ((10, 75), (11, 550), (12, 675), (13, 100)):
            self.assertAlmostEqual(half.dni_W_m2[hour], value, 9)
        stamp = self.convert(pvgis(stamped("30")))
        self.assertAlmostEqual(stamp.dni_W_m2[11], 550, 9)
        self.assertEqual((half.about["states-at"], stamp.about["states-at"]), (0, 1800))
        self.assertAlmostEqual(self.convert(pvgis(more="Irradiance Time Offset (h): -0.5\n")).dni_W_m2[10], 550, 9)
        self.refuse(pvgis(more="Irradiance Time Offset (h): 30\n"), "offset is 30 h")
        self.refuse(pvgis(lambda h, line: stamped("10")(h, line) if h == 3 else line), "weather.csv:21: the minute is 10; all records")
        self.refuse(pvgis(lambda h, line: "\n" + line if h == 24 else line), "a record after the empty line 42, which ends")
        self.refuse(pvgis(lambda h, line: "2009-01-01,1,90,0,0,0,320,2,334,99573\n" if h == 2 else line), "weather.csv:20: '2009-01-01' is not a time")
        self.refuse(pvgis(lambda h, line: "20090101:0200,1,90,0\n" if h == 2 else line), "weather.csv:20: 4 values")
        self.refuse(pvgis(lambda h, line: "" if h == 2 else line), "hours are missing")

    def test_epw_has_hours_that_end(self):
        w = self.convert(epw(), "right.epw")
        self.assertEqual(w.about, {"latitude": 37, "longitude": -5.25, "time-zone": 0, "states-at": 3600})
        self.assertEqual((w.hour[0], len(w.hour), w.T_degC[0], w.dni_W_m2[5], w.dni_W_m2[6], w.wind_m_s[3], w.p_Pa[3]), (59 * 24, 24, 1.5, 0, 500, 2.5, 99000))
        twice = self.convert(epw(records=2), "twice.epw")
        self.assertEqual((len(twice.hour), twice.dni_W_m2[11], twice.about["states-at"]), (24, 750, 2700), "states at the mean of 11:30 and 12:00")
        self.refuse("hour,dni\n", "w.epw:1: this is not an EPW file", "w.epw")
        for row, words in (("2005,3,1,25,0,s,1", "7 columns; an EPW record has 35"), (epw().split("\n")[11].replace("2005,3,1,", "2005,3,32,"), "'03-32' is not a date"),
                           (epw().split("\n")[11].replace(",40,", ",40,5,"), "36 values, but the file has 35 columns. If commas")):
            self.refuse(epw(lambda h, line, row=row: row + "\n" if h == 4 else line), f"w.epw:12: {words}", "w.epw")

    def test_tables_with_other_headings_units_and_separators(self):
        rows = "".join(f"2020-06-01 {h:02d}:00;{0.8 if h == 12 else 0};{59 + 0.9 * h:.1f};3,6;40;0,95\n".replace(".", ",") for h in range(24))
        w = self.convert("Time;DNI [kW/m²];Temperature [°F];Wind speed [km/h];RH [%];Pressure [bar]\n" + rows)
        self.assertEqual(w.about, {"states-at": 0})
        self.assertEqual((w.hour[0], w.dni_W_m2[12], w.wind_m_s[0]), (151 * 24, 800, 1))
        for column, hour, value in (("T_degC", 0, 15), ("T_degC", 10, 20), ("p_Pa", 0, 95000)):
            self.assertAlmostEqual(w.columns[column][hour], value, 9)
        hourly = "hour,Beam,Air temperature (K),Windspeed,RHum,Pressure (hPa)\n" + "".join(f"{h},10,300.15,1,50,950\n" for h in range(24))
        w = self.convert(hourly)
        self.assertEqual((w.T_degC[3], w.p_Pa[3], w.about["states-at"]), (27, 95000, 1800))
        self.refuse(hourly.replace(" (hPa)", ""), "weather.csv:1: the unit of the column 'Pressure' is missing; write for example 'Pressure [mbar]'")

    def test_compressed_files_and_names_of_results(self):
        self.assertEqual(self.convert(gzip.compress(epw().encode()), "a.epw.gz").T_degC[0], 1.5)
        self.refuse(gzip.compress(epw().encode())[:200], "a.epw.gz: this file is damaged or truncated", "a.epw.gz")
        with contextlib.redirect_stdout(io.StringIO()):
            self.assertEqual(dispatch("weather", [str(self.folder / "a.epw.gz"), "-o", str(self.folder / "b.csv.gz")]), 2)
            (self.folder / "a.epw").write_text(epw())
            self.assertEqual(dispatch("weather", [str(self.folder / "a.epw"), "-o", str(self.folder / "b.csv.gz")]), 0)
            self.assertEqual(dispatch("weather", [str(self.folder / "a.epw")]), 0)
        self.assertEqual(gzip.decompress((self.folder / "b.csv.gz").read_bytes()), (self.folder / "a_weather.csv").read_bytes())
        self.refuse(nsrdb(), "out.csv is the file to be converted", "out.csv")

    def test_damaged_files_are_converted_or_refused(self):
        dice, converted = random.Random(1), 0
        for trial in range(400):
            text = dice.choice((nsrdb, tmy3, pvgis, epw))()
            for _ in range(dice.randint(1, 3)):
                at = dice.randrange(len(text))
                text = text[:at] + dice.choice(("", ",", ";", "\n", "x", "nan", "-", "9999", '"', "\t", "\x00", "é", "1e999", "2/30")) + text[at + dice.randint(0, 4):]
            try:
                self.convert(text)
                converted += 1
            except Wrong as error:
                self.assertIn("weather.csv", str(error))
        self.assertTrue(50 < converted < 350, converted)

    def test_the_program_names_the_command_and_reads_what_it_writes(self):
        (self.folder / "case.yaml").write_text((ROOT / "tests/cli/wrong/plant.yaml").read_text().replace("from: 06-01", "from: 03-01").replace("to: 06-03", "to: 03-01"))
        (self.folder / "weather.csv").write_text(epw())

        def check():
            return subprocess.run([BIN / "thermocline", "case.yaml", "--check"], cwd=self.folder, capture_output=True, text=True,
                                  env=dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")).stderr
        said = check()
        command = said.strip().rpartition("must be converted: ")[2].rstrip(".")
        self.assertEqual(command, "couplet weather 'weather.csv' -o 'weather_weather.csv'", said)
        subprocess.run([sys.executable, ROOT / "scripts/couplet", *command.replace("'", "").split()[1:]], cwd=self.folder, check=True, capture_output=True)
        (self.folder / "weather_weather.csv").rename(self.folder / "weather.csv")
        self.assertEqual(check(), "")


if __name__ == "__main__":
    unittest.main(verbosity=0)
