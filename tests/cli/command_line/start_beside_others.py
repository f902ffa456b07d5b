#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A program alone makes no session folder of Open MPI: those of a user's isolated programs are one and the same, and one
that ended while another started let that one fail. Here the folder cannot be made (its parent is a file), so a program
that asks for it ends with exit code 1. Usage: start_beside_others.py PROGRAM FOLDER_OF_CASES"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

program, cases = sys.argv[1], pathlib.Path(sys.argv[2])
with tempfile.TemporaryDirectory(prefix="couplet-start-") as name:
    folder = pathlib.Path(name)
    for file in ("square.msh", "solid.yaml"):
        shutil.copy(cases / file, folder)
    (folder / "no-folder").write_text("")
    environment = {key: value for key, value in os.environ.items() if not key.startswith("OMPI_MCA_")}
    environment["OMPI_MCA_orte_tmpdir_base"] = str(folder / "no-folder")
    # With a checkpoint: files are written by MPI-IO, which could want the folder, too.
    result = subprocess.run([program, "solid.yaml", "--set", "simulation.checkpoint.interval=1",
                             "--accept", "error-estimate"], cwd=folder, env=environment,
                            capture_output=True, text=True, timeout=100, check=False)
    if result.returncode != 0:
        sys.exit(f"exit code {result.returncode}\n{result.stderr}")
    if not any(folder.rglob("*.h5")):
        sys.exit("nothing was written: " + ", ".join(str(p.relative_to(folder)) for p in folder.rglob("*")))
