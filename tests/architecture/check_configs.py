#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every configs/*/case.yaml passes --check of every program it names. Usage: check_configs.py CONFIGS BIN"""
import pathlib
import re
import subprocess
import sys

OURS = ("solid_solver", "fluid_solver", "mesh_mover", "coupler", "plate_modal", "thermocline")
configs, programs = map(pathlib.Path, sys.argv[1:3])
cases = sorted(configs.glob("*/case.yaml"))
failed = 0 if cases else 1
for case in cases:
    text = case.read_text()
    # (participant, program) pairs, and the coupler where there is a coupling section
    asked = re.findall(r"^  ([\w-]+):\s*\n(?:\s*#.*\n)*    program: (\w+)", text, flags=re.M)
    if not asked:
        print(f"{case}: no participant found")
        failed += 1
    jobs = [[program, str(case), "--check", "--participant", name] for name, program in asked]
    if re.search(r"^coupling:", text, flags=re.M):
        jobs.append(["coupler", str(case), "--check"])
    for job in jobs:
        if not (programs / job[0]).exists() and job[0] not in OURS:
            print(f"{case.parent.name}: {job[0]}: a program of somebody else")
            continue
        result = subprocess.run([str(programs / job[0]), *job[1:]], capture_output=True, text=True)
        verdict = "valid" if result.returncode == 0 else f"exit code {result.returncode}\n{result.stdout}{result.stderr}"
        print(f"{case.parent.name}: {job[0]}: {verdict}")
        failed += result.returncode != 0
sys.exit(1 if failed else 0)
