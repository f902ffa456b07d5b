# SPDX-License-Identifier: Apache-2.0
"""Runs every command of a tutorial or how-to page in order, in an empty folder with an empty HOME. Each must succeed, and a tutorial must draw pictures.
Usage: tutorials.py BIN PAGE, such as tutorials/first-solid or how-to/modes"""
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from scene import ROOT, environment
from checks import check, end  # noqa: E402
import couplet  # noqa: E402

bin_, page = pathlib.Path(sys.argv[1]), sys.argv[2]
FEWEST = (2, 1) if page.startswith("tutorials/") else (1, 0)  # blocks of commands, pictures
PICTURES = {"tutorials/accuracy": 2}

text = (ROOT / f"docs/{page}.md").read_text()
blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.M | re.S)
with tempfile.TemporaryDirectory(prefix="couplet-tutorial-") as scratch:
    home = pathlib.Path(scratch) / "home"
    home.mkdir()
    env = {**environment(bin_), "HOME": str(home), "PATH": f"{ROOT / 'scripts'}:/usr/bin:/bin", "PYTHONPATH": str(ROOT / "client/python")}
    start = time.monotonic()
    for block in blocks:
        said = subprocess.run(["bash", "-ec", block], capture_output=True, text=True, env=env, cwd=home, timeout=600)
        first = block.strip().splitlines()[0]
        check(first, said.returncode == 0 and "Traceback" not in said.stderr, (said.stdout[-1500:] + said.stderr[-1500:]) if said.returncode else "")
    if page == "tutorials/own-mesh":  # what is drawn is the hook: 10 mm of 100 mm and of half a ring
        area = couplet.Results(home / "hook/out").fields("solid").volumes().sum()
        check("the hook is a strip", abs(area / (1e-3 + 0.5 * math.pi * (0.05**2 - 0.04**2)) - 1) < 0.02, area)
    pictures = [p for p in home.rglob("*.png") if p.stat().st_size > 3000]
    check(f"{len(blocks)} blocks in {time.monotonic() - start:.0f} s, {len(pictures)} pictures", len(blocks) >= FEWEST[0] and len(pictures) >= PICTURES.get(page, FEWEST[1]), pictures)
end()
