# SPDX-License-Identifier: Apache-2.0
"""Measures of weather, plant, reports and studies: identities, tables 5.3, 5.5 and 5.6 of the thesis beside ours, and the cost of
the study on one and on two processors."""
import csv
import re

TESTS = "unit_thermocline_plant"
CASES = {"A": ("thermocline-andasol", "table5_5.csv"), "G": ("thermocline-gemasolar", "table5_6.csv")}
VARIANTS = ("B", "AR1", "AR2", "CO1", "CO2", "S1", "L1", "L2", "T1")
# Row of the published table: our name of it.
ROWS = {"Q_SF": "Q_SF", "Q_excess/Q_SF": "Q_excess/Q_SF", "Q_C/Q_excess": "Q_C/Q_excess", "Q_D/Q_C": "Q_D/Q_C", "B_D": "B_D",
        "Q_lacking/Q_PB": "Q_lacking/Q_PB", "Energy_losses": "energy losses", "t_charge": "charge time",
        "t_discharge": "discharge time", "t_standby_charged": "charged stand-by time",
        "t_standby_discharged": "discharged stand-by time", "time_TCout<Tcold+5": "time with cold outlet",
        "time_TDout>Thot-5": "time with hot outlet", "eta_th": "eta_th", "h_th/h_bed": "h_th/h_bed",
        "FoS_static": "FoS_static", "FoS_dynamic": "FoS_dynamic"}


# -- tables -----------------------------------------------------------------------------------------------------------
def read_table(file):
    """{row: {variant: number}} of a table with the columns result or quantity, unit, variants."""
    with open(file, newline="") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    key = next(iter(rows[0]))
    return {row[key]: {v: float(row[v]) for v in VARIANTS if row.get(v)} for row in rows}


def published(job, case):
    folder, file = CASES[case]
    return read_table(job.root / "configs" / folder / "reference" / file)


def study(job, case, changes=(), only=",".join(VARIANTS)):
    """Our table: the study of the case with the built program."""
    folder = CASES[case][0]
    out = job.scratch / f"study-{case}-{abs(hash((changes, only)))}"

    def make():
        command = [job.root / "scripts/couplet", "study", job.root / "configs" / folder / "case.yaml", f"--only={only}", f"--out={out}",
                   f"--build={job.build}"]
        job.done([*command, *(f"--set={c}" for c in changes)], timeout=7200)
        return read_table(out / "table.csv")
    return job.once(out.name, make)


TVD = ("participants.tank.bed.advection=tvd", "participants.tank.bed.courant=0.5")
MEAN_DAYS = ("participants.tank.ambient.days=monthly-mean",)


def shown(values):
    return " ".join(f"{values[v]:.4g}" if v in values else "-" for v in VARIANTS)


def row(job, case, name, points=None, percent=None):
    """A row of a table: all variants within so many points or per cent; the other columns are for the reader."""
    wanted, ours = published(job, case)[name], study(job, case)[ROWS[name]]
    tvd = study(job, case, TVD)[ROWS[name]]

    def far(values):
        gap = {v: abs(values[v] - wanted[v]) for v in VARIANTS}
        return [v for v in VARIANTS if not (points is not None and gap[v] <= points) and not (
            percent is not None and gap[v] <= percent / 100 * abs(wanted[v]))]
    outside = far(ours)
    text = f"{shown(ours)} (published {shown(wanted)}); outside: {' '.join(outside) or 'none'}; TVD: {shown(tvd)}"
    if name not in ("Q_SF", "FoS_static"):
        mean = study(job, case, MEAN_DAYS)[ROWS[name]]
        text += f"; with the sun of monthly mean days: {shown(mean)}, outside: {' '.join(far(mean)) or 'none'}"
    if outside and name not in ("Q_SF", "FoS_static"):
        excess = study(job, case)["Q_excess/Q_SF"], published(job, case)["Q_excess/Q_SF"]
        text += (f". Cause: the surrogate's days are stronger and shorter, Q_excess/Q_SF {shown(excess[0])} % for the published "
                 f"{shown(excess[1])}")
    return text, not outside


# -- identities -------------------------------------------------------------------------------------------------------
def solar_field(job):
    tests, _ = job.gtest(TESTS)
    chosen = {k: v for k, v in tests.items() if "SolarField" in k}
    got = " ".join(f"{float(v['field_heat']):.1f}/{float(v['published']):.0f}" for v in chosen.values())
    return got, len(chosen) == 8 and all(v["passed"] for v in chosen.values())


# -- cost -------------------------------------------------------------------------------------------------------------
def scaling(job):
    """The 18 variants over fewer days, one and two at a time, alternately: the better time of each."""
    command = [job.root / "scripts/couplet", "study", *(job.root / "configs" / folder / "case.yaml" for folder, _ in CASES.values()),
               f"--only={','.join(VARIANTS)}", f"--build={job.build}", f"--out={job.scratch / 'scaling'}", "--again",
               "--set=simulation.end-time=10 day", "--set=participants.tank.report.run-in=2 day"]
    seconds = {1: [], 2: []}
    for jobs in (1, 2, 1, 2):
        result = job.run([*command, f"--jobs={jobs}"], timeout=3600)
        seconds[jobs].append(float(re.search(r"variants in ([\d.]+) s", result.stdout).group(1)))
    ratio = min(seconds[1]) / min(seconds[2])
    return f"{min(seconds[1]):.1f} s and {min(seconds[2]):.1f} s for 10 days of 18 variants: {ratio:.2f} times", ratio >= 1.8


def base_speed(job):
    """Four months of case A."""
    out = job.scratch / "base-speed"
    result = job.run([job.build / "bin/thermocline", job.root / "configs/thermocline-andasol/case.yaml",
                      f"--set=simulation.output.folder={out}"])
    total = float(re.search(r"total\s+([\d.]+)", result.stdout).group(1))
    return f"{total:.0f} s; {re.search(r'speed: (.*)', result.stdout).group(1)}", total <= 25
