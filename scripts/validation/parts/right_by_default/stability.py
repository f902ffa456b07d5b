# SPDX-License-Identifier: Apache-2.0
"""Buckling against closed forms, and equilibria that do not hold."""
import json

LEE = 18.5


def snap(job):
    """The first limit load [kN] in run.json, and what else the run has to say."""
    run = job.alone("lees-frame")
    findings = json.loads((run.folder / "solid" / "run.json").read_text())["findings"]
    found = next(f["number"] for f in findings if f["id"] == "limit-load")
    worse = [f["id"] for f in findings if f["severity"] != "note"]
    error = found / LEE - 1
    return f"{found:.4g} kN ({100 * error:+.2f} %), {', '.join(worse) or 'no warning'}", abs(error) <= 0.02 and not worse
