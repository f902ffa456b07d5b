#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""--check refuses and flags none of the cases in configs/. usage: shipped.py BIN_FOLDER CONFIGS"""
import pathlib
import subprocess
import sys

import yaml

# Second stages: what they read another case of the folder writes.
NEEDS_A_RUN = {"bracket-modes/modal.yaml": "modes.file: the file 'out/bracket/modes.h5' does not exist",
               "reed-slice/modes.yaml": "modes.file: the file 'out-shapes/reed/modes.h5' does not exist"}


def participants(case):
    return [(name, section.get("program", "")) for name, section in (case.get("participants") or {}).items()]


def main():
    binaries, configs = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    bad, tried, cases = [], 0, 0
    for file in sorted(configs.rglob("*.yaml")):
        case = yaml.safe_load(file.read_text(encoding="utf-8"))
        if not isinstance(case, dict) or "participants" not in case or "out" in file.relative_to(configs).parts:
            continue
        cases += 1
        calls = [(program, ["--participant", name]) for name, program in participants(case) if (binaries / program).exists()]
        calls += [("coupler", [])] * ("coupling" in case)
        for program, words in calls:
            result = subprocess.run([binaries / program, file.name, "--check", *words], cwd=file.parent, capture_output=True, text=True,
                                    timeout=60, check=False)
            tried += 1
            name = str(file.relative_to(configs))
            known = NEEDS_A_RUN.get(name)
            if known and known in result.stderr and result.stderr.count("\n") == 1:
                continue
            if result.returncode != 0 or "warning" in result.stderr:
                bad.append(f"{file.relative_to(configs)} {' '.join([program, *words])}: {result.stderr.strip()[-400:]}")
    print("\n".join(bad))
    print(f"{tried} participants of {cases} cases, {len(bad)} refused or flagged")
    return 1 if bad or cases < 40 else 0


if __name__ == "__main__":
    sys.exit(main())
