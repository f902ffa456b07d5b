# SPDX-License-Identifier: Apache-2.0
"""Runs every command of a page of docs/ in order, in an empty folder with an empty HOME. Each must succeed, and a tutorial must draw pictures.
Usage: tutorials.py BIN PAGE [PLACE], such as tutorials/first-solid or how-to/modes. PAGE newcomer: README, quick start and all tutorials, without the
lines that build and install, which chroot.py runs. PLACE is that of the command: the checkout, a prefix (where the quick start installs), or the
unpacked deb."""
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

from scene import ROOT, environment
from checks import check, end  # noqa: E402
import couplet  # noqa: E402

bin_, asked, place = pathlib.Path(sys.argv[1]), sys.argv[2], (sys.argv[3:] or ["checkout"])[0]
PAGES = ["../README", "quickstart", *sorted(f"tutorials/{file.stem}" for file in (ROOT / "docs/tutorials").glob("*.md"))] if asked == "newcomer" else [asked]
BUILDS = re.compile(r"^(sudo|cmake|cd build|scripts/|export PATH).*\n", flags=re.M)
SITE = re.compile(r"^couplet docs .*\n", flags=re.M)  # would serve until it is interrupted; command_site builds it
PICTURES = {"tutorials/accuracy": 2}
NUMBERS = {  # page: (file, column, row, value that the page tells)
    "how-to/modes": ("part/out/part/modes.csv", "frequency [Hz]", 0, 304.4),
    "how-to/pressure-vessel": ("vessel/out/vessel/probes.csv", "cylinder stress-zz [Pa]", -1, 102.07e6),
    "how-to/thermal-stress": ("strip/out/strip/probes.csv", "tip temperature [K]", -1, 360.07),
    "how-to/plate-for-solid": ("panel/out/structure/probes.csv", "tip x [m]", -1, 11.87e-3),
}



def set_up(home):
    """Commands of a shell that make the command known, as the quick start does."""
    told = {("prefix" if "~" in line else "checkout"): line for line in re.findall(r"^(export PATH=.*?)(?: *#.*)?$", (ROOT / "docs/quickstart.md").read_text(), flags=re.M)}
    if place == "checkout":
        return f"cd {ROOT}; {told[place]}; cd {home}; "
    if place == "prefix":
        subprocess.run(["cmake", "--install", bin_.parent, "--prefix", home / ".local"], check=True, capture_output=True)
        return told[place] + "; "
    subprocess.run(["cpack", "-B", home / "deb"], cwd=bin_.parent, check=True, capture_output=True)
    subprocess.run(["dpkg", "-x", next((home / "deb").glob("*.deb")), home / "root"], check=True)
    return f"export PATH={home}/root/usr/bin:$PATH PYTHONPATH={home}/root/usr/lib/python3/dist-packages; "  # where the system looks if it is installed


def follow(page, home, begin, env):
    text, start = (ROOT / f"docs/{page}.md").read_text(), time.monotonic()
    blocks = re.findall(r"^```sh\n(.*?)^```", text, flags=re.M | re.S)
    if not page.startswith(("tutorials/", "how-to/")):
        blocks = [left for block in blocks if (left := SITE.sub("", BUILDS.sub("", block)).strip())]
    fewest = (2, 1) if page.startswith("tutorials/") else (1, 0)  # blocks of commands, pictures
    for block in blocks:
        said = subprocess.run(["bash", "-ec", begin + block], capture_output=True, text=True, env=env, cwd=home, timeout=600)
        first = block.strip().splitlines()[0]
        check(first, said.returncode == 0 and "Traceback" not in said.stderr, (said.stdout[-1500:] + said.stderr[-1500:]) if said.returncode else "")
    if page == "tutorials/own-mesh":  # what is drawn is the hook: 10 mm of 100 mm and of half a ring
        area = couplet.Results(home / "hook/out").fields("solid").volumes().sum()
        check("the hook is a strip", abs(area / (1e-3 + 0.5 * math.pi * (0.05**2 - 0.04**2)) - 1) < 0.02, area)
    if page in NUMBERS:
        file, column, row, told = NUMBERS[page]
        found = couplet.read_csv(home / file)[column][row]
        check(f"{column} is what the page tells", abs(found / told - 1) < 1e-3, (found, told))
    pictures = [p for p in home.rglob("*.png") if p.stat().st_size > 3000 and "share" not in p.parts]
    check(f"{page}: {len(blocks)} blocks in {time.monotonic() - start:.0f} s, {len(pictures)} pictures", len(blocks) >= fewest[0] and len(pictures) >= PICTURES.get(page, fewest[1]), pictures)


with tempfile.TemporaryDirectory(prefix="couplet-tutorial-") as scratch:
    home = pathlib.Path(scratch) / "home"
    home.mkdir()
    env = {**environment(bin_), "HOME": str(home), "PATH": "/usr/bin:/bin"}
    env.pop("PYTHONPATH", None)
    if place != "checkout" or bin_ == ROOT / "build/bin":
        del env["COUPLET_BIN"]
    begin = set_up(home)
    for page in PAGES:
        follow(page, home, begin, env)
        for left in home.iterdir():  # each page begins in an empty folder
            if left.name not in (".local", "deb", "root", ".cache", ".config"):
                shutil.rmtree(left) if left.is_dir() else left.unlink()
end()
