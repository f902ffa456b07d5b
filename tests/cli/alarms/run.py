# SPDX-License-Identifier: Apache-2.0
"""Findings of every shipped case, configs/*/case*.yaml, with its default settings: each must be listed with its reason in docs/findings.md,
none may be `wrong`. A case that takes longer than SECONDS is stopped by a signal, and its findings until then count; the line says so.
Usage: run.py BIN ROOT [--seconds SECONDS] [--only CASE...] [--json FILE]"""
import argparse
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

import yaml

DECIDED = "## Findings of the shipped cases"


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--seconds", type=float, default=40)
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--json", type=pathlib.Path)
    return parser.parse_args()


def defended(text):
    """(case, id) of the table in docs/findings.md."""
    rows = re.findall(r"^\| `([\w/.-]+)` \| `([\w-]+)` \| (.+) \|$", text.partition(DECIDED)[2], flags=re.M)
    return {(case, identity) for case, identity, reason in rows if reason.strip()}


def launch_line(programs, case, folder):
    text = yaml.safe_load(case.read_text())
    names = [(p.get("program"), name) for name, p in text["participants"].items() if isinstance(p, dict) and "program" in p]
    if any(not (programs / program).exists() for program, _ in names):
        return None, 0
    if any(".cache." in str(p.get("mesh", "")) and not (case.parent / p["mesh"]).exists() for p in text["participants"].values() if isinstance(p, dict)):
        return None, 0
    words = [str(case), "--strict=effects", f"--set=simulation.output.folder={folder}"]
    if "coupling" not in text:  # participants of a case without coupling run one by one; the first speaks for it
        return [str(programs / names[0][0]), *words, "--participant", names[0][1]], text["simulation"]["end-time"]
    line = ["mpirun", "--oversubscribe", "--mca", "odls_base_sigkill_timeout", "30", "-n", "1", str(programs / "coupler"), *words]
    for program, name in names:
        line += [":", "-n", "1", str(programs / program), *words, "--participant", name]
    return line, text["simulation"]["end-time"]


def run(line, folder, seconds):
    """Exit code, whether it was stopped, all text."""
    with open(folder / "log.txt", "w+", encoding="utf-8") as log:
        process = subprocess.Popen(line, stdout=log, stderr=subprocess.STDOUT)
        stopped = False
        try:
            process.wait(seconds)
        except subprocess.TimeoutExpired:
            stopped = True
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(240)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        log.seek(0)
        return process.returncode, stopped, log.read()


def main():
    options = arguments()
    allowed = defended((options.root / "docs/findings.md").read_text())
    failed, all_found = [], {}
    for case in sorted((options.root / "configs").glob("*/case*.yaml")):
        label = case.parent.name if case.name == "case.yaml" else f"{case.parent.name}/{case.name}"
        if options.only and label not in options.only:
            continue
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            line, end = launch_line(options.bin, case, folder / "out")
            if line is None:
                print(f"{label}: a program of somebody else, or a mesh that a script makes first", flush=True)
                continue
            start = time.monotonic()
            code, stopped, text = run(line, folder, options.seconds)
            reports = {f.parent.name: json.loads(f.read_text()) for f in (folder / "out").glob("*/run.json")}
        found = {(i["id"], i["severity"]): i for r in reports.values() for i in r["findings"]}
        seen = max((r["time"] for r in reports.values()), default=0)
        all_found[label] = {"code": code, "stopped": stopped, "time": seen, "seconds": round(time.monotonic() - start, 1), "findings": list(found.values())}
        trouble = [f"{i} ({s}): {found[i, s]['sentence']}" for i, s in found if s == "wrong" or s == "warning" and not found[i, s]["accepted"] and (label, i) not in allowed]
        if not reports:
            trouble.append(f"no run.json: {text[-300:]}")
        expected = (0, 1, 3) if any(s == "warning" for _, s in found) else (0, 3)
        if code not in expected and not stopped:
            trouble.append(f"exit code {code}: {text[-300:]}")
        shortened = f"stopped at {seen:g} s of {end} after {options.seconds:g} s" if stopped else "to its end"
        print(f"{label}: {shortened}: {', '.join(i for i, _ in found) or 'nothing'}{'; NOT DEFENDED: ' + '; '.join(trouble) if trouble else ''}", flush=True)
        failed += [f"{label}: {t}" for t in trouble]
    if options.json:
        options.json.write_text(json.dumps({"cases": all_found, "failed": failed}, indent=1))
    wrong = sum(f["severity"] == "wrong" for c in all_found.values() for f in c["findings"])
    total = sum(len(c["findings"]) for c in all_found.values())
    print(f"{len(all_found)} cases ({sum(c['stopped'] for c in all_found.values())} shortened), {total} findings, {wrong} wrong, {len(failed)} not defended")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
