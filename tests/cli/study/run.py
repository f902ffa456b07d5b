#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""scripts/couplet study: its variants differ as told, its table is their summaries, and what is wrong is said. usage: run.py BUILD"""
import csv
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "tests/cli/wrong")]
import table

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from checks import check  # noqa: E402

WEATHER = next(c.files for c in table.CASES if c.name == "right plant")
STUDY = """
study:
  variants:
    base: {}
    large-field: {flow.field-area: 20000 m^2}
    short: {simulation.end-time: 12 h}
  sweeps:
    diameter: {key: diameter, values: [8 m, 12 m]}
"""


def study(build, folder, text, *options):
    (folder / "case.yaml").write_text((ROOT / "tests/cli/wrong/plant.yaml").read_text() + text)
    for name, content in WEATHER.items():
        (folder / name).write_text(content)
    return subprocess.run([ROOT / "scripts/couplet", "study", folder / "case.yaml", f"--build={build}", *options], capture_output=True,
                          text=True)


def main(build):
    failed = 0
    with tempfile.TemporaryDirectory(prefix="couplet-study-") as name:
        folder = pathlib.Path(name)
        result = study(build, folder, STUDY, "--jobs=2")
        failed += check("all variants run", result.returncode == 0 and "5 of 5 variants" in result.stdout, result.stdout + result.stderr)
        with open(folder / "out/study/table.csv", newline="") as file:
            rows = {row["quantity"]: row for row in csv.DictReader(file)}
        columns = list(rows["Q_SF"])[2:]
        failed += check("the table has a column a variant", sorted(columns) == ["base", "diameter-12m", "diameter-8m", "large-field", "short"],
                        str(columns))
        field = {c: float(rows["Q_SF"][c]) for c in columns}
        failed += check("a variant's change is in force", abs(field["large-field"] / field["base"] - 2) < 1e-4, str(field))
        efficiency = [float(rows["eta_th"][f"diameter-{d}m"]) for d in (8, 12)]
        failed += check("a sweep's values are in force", efficiency[0] > efficiency[1] > 0, str(efficiency))
        result = study(build, folder, STUDY, "--only=diameter-*", "--list")
        failed += check("--only and --list", result.returncode == 0 and len(result.stdout.strip().splitlines()) == 2, result.stdout)
        result = study(build, folder, "\nstudy:\n  variants:\n    bad: {flow.feld-area: 1 m^2}\n    good: {}\n")
        failed += check("a wrong key fails its variant alone", result.returncode == 1 and "1 of 2 variants" in result.stdout
                        and "feld-area" in result.stdout, result.stdout + result.stderr)
        result = study(build, folder, "\nstudy: {variant: {}}\n")
        failed += check("an unknown key of the section", result.returncode != 0 and "unknown key 'variant'" in result.stderr, result.stderr)
        result = study(build, folder, "")
        failed += check("a case without a study", result.returncode != 0 and "there is no section 'study'" in result.stderr, result.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]).resolve()))
