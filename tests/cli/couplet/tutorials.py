# SPDX-License-Identifier: Apache-2.0
"""Runs every command of a page of docs/ in order, in an empty folder with an empty HOME, or in a copy of the shipped cases if the page runs these. Each
must succeed, a sample of output (a block ```text after it) must be what comes, numbers within 2 %, and a tutorial must draw pictures. The figure of
a page is one of them: --figures copies it to docs/pictures, with fewer colors.
Usage: tutorials.py BIN PAGE [PLACE | --figures], such as tutorials/first-solid or how-to/modes. PAGE newcomer: README, quick start and all tutorials, without the
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
from samples import is_said  # noqa: E402
import couplet  # noqa: E402

bin_, asked, place = pathlib.Path(sys.argv[1]), sys.argv[2], (sys.argv[3:] or ["checkout"])[0]
PAGES = ["../README", "quickstart", *sorted(f"tutorials/{file.stem}" for file in (ROOT / "docs/tutorials").glob("*.md"))] if asked == "newcomer" else [asked]
BUILDS = re.compile(r"^(sudo|cmake|cd build|scripts/|export PATH).*\n", flags=re.M)
SITE = re.compile(r"^couplet docs .*\n", flags=re.M)  # would serve until it is interrupted; command_site builds it
PICTURES = {"tutorials/accuracy": 2}
FIGURES = {  # page: (picture that its commands draw, width of the figure)
    "tutorials/first-solid": ("beam/out/solid/equivalent-stress.png", 700),
    "tutorials/first-fluid": ("box/out/fluid/velocity.png", 560),
    "tutorials/first-coupled": ("flap/out/fluid/velocity.png", 760),
    "tutorials/own-mesh": ("hook/out/hook.png", 1000),
    "tutorials/own-coupled": ("baffle/out/water/velocity.png", 800),
    "tutorials/own-participant": ("cylinder/out/fluid/forces.png", 760),
    "tutorials/accuracy": ("beam/out/study/error-tip.png", 760),
    "tutorials/tank-year": ("tank/out/tank/plant.png", 760),
    "tutorial-solid": ("configs/thick-plate/out/thick-plate.png", 1000),
    "how-to/modes": ("part/out/part/mode-1.png", 700),
    "how-to/drag-and-lift": ("street/out/fluid/coefficients.png", 760),
    "how-to/heat-in-the-fluid": ("warm/out/fluid/heat.png", 760),
    "how-to/conjugate-heat": ("plate/out/plate.png", 760),
    "how-to/rigid-bodies": ("valve/out/leaflet/probes.png", 640),
    "how-to/paraview": ("flap/out/solid/equivalent-stress.png", 500),
    "how-to/pressure-vessel": ("vessel/out/vessel/equivalent-stress.png", 560),
    "how-to/tank-weather": ("tank/out/tank/days.png", 760),
    "how-to/thermal-stress": ("strip/out/strip/temperature.png", 800),
    "how-to/waveforms": ("beat/out/fluid/balance.png", 760),
    "how-to/accuracy": ("beam/out/study/order-tip.png", 640),
    "how-to/calculix-deck": ("arm/out/solid/equivalent-stress.png", 640),
    "how-to/own-mesh": ("lug/out/lug/equivalent-stress.png", 560),
    "how-to/own-solver-python": ("cylinder/out/coupler/residuals.png", 640),
    "how-to/restart": ("flap/out/solid/probes.png", 640),
    "how-to/read-results-python": ("tip.png", 640),
}
NUMBERS = {  # page: (file, column, row, value that the page tells)
    "how-to/modes": ("part/out/part/modes.csv", "frequency [Hz]", 0, 304.4),
    "how-to/pressure-vessel": ("vessel/out/vessel/probes.csv", "cylinder stress-zz [Pa]", -1, 102.07e6),
    "how-to/thermal-stress": ("strip/out/strip/probes.csv", "tip temperature [K]", -1, 360.07),
    "how-to/plate-for-solid": ("panel/out/structure/probes.csv", "tip x [m]", -1, 11.87e-3),
}



def set_up(home):
    """Commands of a shell that make the command known, as the quick start does."""
    told = {("prefix" if "~" in line else "checkout"): line for line in re.findall(r"^(export PATH=.*?)(?: *#.*)?$", (ROOT / "docs/quickstart.md").read_text(), flags=re.M)}
    if place in ("checkout", "--figures"):
        return f"cd {ROOT}; {told['checkout']}; cd {home}; "
    if place == "prefix":
        subprocess.run(["cmake", "--install", bin_.parent, "--prefix", home / ".local"], check=True, capture_output=True)
        return told[place] + "; "
    subprocess.run(["cpack", "-B", home / "deb"], cwd=bin_.parent, check=True, capture_output=True)
    subprocess.run(["dpkg", "-x", next((home / "deb").glob("*.deb")), home / "root"], check=True)
    return f"export PATH={home}/root/usr/bin:$PATH PYTHONPATH={home}/root/usr/lib/python3/dist-packages; "  # where the system looks if it is installed


def cases_into(home):
    """Copies the shipped cases, two of them shortened, and links what the commands of a page take from the root of the checkout."""
    shutil.copytree(ROOT / "configs", home / "configs", ignore=shutil.ignore_patterns("out", "out-*", "*.cache.msh", "__pycache__"))
    for name, time in (("perpendicular-flap", "0.03 s"), ("cavity", "0.5 s")):
        case = home / "configs" / name / "case.yaml"
        case.write_text(re.sub(r"end-time: .*", f"end-time: {time}", case.read_text(), count=1))
    (home / "build").mkdir()
    for link, target in (("scripts", ROOT / "scripts"), ("build/bin", bin_.absolute())):
        (home / link).symlink_to(target)


def figure_of(page):
    """File of a page's figure. A guide with the name of a tutorial has a longer one."""
    name = page.rpartition("/")[2]
    twice = page.startswith("how-to/") and (ROOT / f"docs/tutorials/{name}.md").exists()
    return ROOT / f"docs/pictures/{'how-to-' if twice else ''}{name}.png"


def figure(page, picture, width):
    """Writes a page's figure to docs/pictures, at most as wide as asked, in 64 colors."""
    from PIL import Image
    drawn = Image.open(picture).convert("RGB")
    size = (min(width, drawn.width), round(drawn.height * min(1, width / drawn.width)))
    drawn.resize(size, Image.LANCZOS).quantize(64, dither=Image.Dither.NONE).save(figure_of(page), optimize=True)


def follow(page, home, begin, env):
    text, start = (ROOT / f"docs/{page}.md").read_text(), time.monotonic()
    fenced = re.findall(r"^```(\w*)\n(.*?)^```", text, flags=re.M | re.S)
    blocks = [block for language, block in fenced if language == "sh"]
    samples = {block: sample for (_, block), (language, sample) in zip(fenced, fenced[1:]) if language == "text"}
    if any("configs/" in block for block in blocks) and page.startswith(("how-to/", "tutorial")):
        cases_into(home)
    if not page.startswith(("tutorials/", "how-to/")):
        blocks = [left for block in blocks if (left := SITE.sub("", BUILDS.sub("", block)).strip())]
    fewest = (2, 1) if page.startswith("tutorials/") else (1, 0)  # blocks of commands, pictures
    for block in blocks:
        said = subprocess.run(["bash", "-ec", begin + block], capture_output=True, text=True, env=env, cwd=home, timeout=600)
        first = block.strip().splitlines()[0]
        check(first, said.returncode == 0 and "Traceback" not in said.stderr, (said.stdout[-1500:] + said.stderr[-1500:]) if said.returncode else "")
        for line in samples.get(block, "").splitlines():
            check(f"the sample is what comes: {line}", is_said(line, said.stdout + said.stderr), [s for s in (said.stdout + said.stderr).splitlines() if s[:15] == line[:15]])
    if page == "tutorials/own-mesh":  # what is drawn is the hook: 10 mm of 100 mm and of half a ring
        area = couplet.Results(home / "hook/out").fields("solid").volumes().sum()
        check("the hook is a strip", abs(area / (1e-3 + 0.5 * math.pi * (0.05**2 - 0.04**2)) - 1) < 0.02, area)
    if page in NUMBERS:
        file, column, row, told = NUMBERS[page]
        found = couplet.read_csv(home / file)[column][row]
        check(f"{column} is what the page tells", abs(found / told - 1) < 1e-3, (found, told))
    if page in FIGURES:
        picture, width = FIGURES[page]
        file = figure_of(page)
        if place == "--figures":
            figure(page, home / picture, width)
        check("the page has its figure, which its commands draw", (home / picture).is_file() and f"pictures/{file.name})" in text and file.is_file() and file.stat().st_size < 1e5)
    pictures = [p for p in home.rglob("*.png") if p.stat().st_size > 3000 and "share" not in p.parts and p.name != "picture.png"]
    check(f"{page}: {len(blocks)} blocks in {time.monotonic() - start:.0f} s, {len(pictures)} pictures", len(blocks) >= fewest[0] and len(pictures) >= PICTURES.get(page, fewest[1]), pictures)


with tempfile.TemporaryDirectory(prefix="couplet-tutorial-") as scratch:
    home = pathlib.Path(scratch) / "home"
    home.mkdir()
    env = {**environment(bin_), "HOME": str(home), "PATH": "/usr/bin:/bin"}
    env.pop("PYTHONPATH", None)
    if place in ("prefix", "deb") or bin_ == ROOT / "build/bin":
        del env["COUPLET_BIN"]
    begin = set_up(home)
    for page in PAGES:
        follow(page, home, begin, env)
        for left in home.iterdir():  # each page begins in an empty folder
            if left.name not in (".local", "deb", "root", ".cache", ".config"):
                shutil.rmtree(left) if left.is_dir() and not left.is_symlink() else left.unlink()
end()
