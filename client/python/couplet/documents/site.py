# SPDX-License-Identifier: Apache-2.0
"""Site with all documents, the READMEs of cases and folders, and a gallery of all cases, built by MkDocs with its
Material theme. The sidebar sorts pages by kind. The search leaves out pages for developers. The site loads nothing from
other servers."""
import functools
import html
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

from couplet import files
from couplet.documents import plots, reference
from couplet.places import ROOT
from couplet.places import build as build_folder
from couplet.runs.case import expect
from couplet.runs.gallery import entries

# Pages by kind (https://diataxis.fr). All others, except cases, are for developers.
TUTORIALS = (
    "docs/quickstart.md",
    "docs/tutorials/first-solid.md",
    "docs/tutorials/first-fluid.md",
    "docs/tutorials/first-coupled.md",
    "docs/tutorials/own-mesh.md",
    "docs/tutorials/own-coupled.md",
    "docs/tutorials/own-participant.md",
    "docs/tutorials/accuracy.md",
    "docs/tutorials/tank-year.md",
    "docs/tutorial-solid.md",
)
REFERENCE = (
    "docs/command.md",
    "docs/python.md",
    "docs/config.md",
    *(f"docs/keys/{program}.md" for program in reference.PROGRAMS),
    "docs/effects.md",
    "docs/findings.md",
    "docs/limitations.md",
    "docs/formats.md",
    "docs/meshes.md",
    "docs/input-data.md",
    "docs/expressions.md",
    "docs/quantities.md",
    "docs/plots.md",
    "docs/checkpoints.md",
    "docs/precice.md",
    "docs/protocol.md",
    "docs/glossary.md",
    "CHANGELOG.md",
)
THEORY = tuple(
    f"docs/theory/{name}.md"
    for name in (
        "README",
        "solid",
        "solid-gradients",
        "solid-motion",
        "solid-solution",
        "heat-contact",
        "fluid",
        "fluid-models",
        "mesh-motion",
        "coupling",
    )
)
EXPLANATION = (
    "docs/coupling.md",
    "docs/mapping.md",
    "docs/large-strain.md",
    "docs/plate.md",
    "docs/thermocline.md",
    "docs/plant.md",
    "docs/stability.md",
    "docs/error-estimates.md",
    "docs/studies.md",
    "docs/benchmarks.md",
)
GENERATED = ("docs/command.md", "docs/python.md", "docs/config.md", "docs/effects.md", "docs/stability.md")
# MathJax as Debian packages it, with the parts that the configuration below loads.
MATHJAX = pathlib.Path("/usr/share/javascript/mathjax")
MATHJAX_PARTS = (
    "MathJax.js",
    "config/TeX-AMS_CHTML-full.js",
    "jax/output/CommonHTML",
    "jax/element/mml/optable",
    "fonts/HTML-CSS/TeX/woff",
    "extensions",
)
LEFT_OUT = re.compile(r"(^|/)(out|out-[^/]*|build[^/]*|__pycache__|\.[^/]*)(/|$)")
HERE = pathlib.Path(__file__).parent


@functools.cache
def of_programs():
    """{path: text} of the pages that the programs tell."""
    return {pathlib.Path(name): text for name, text in reference.pages(build_folder() / "bin").items()}


def text_of(page):
    return of_programs().get(page) or (ROOT / page).read_text()


def pages():
    """All Markdown files of the project, by relative path, and the pages of keys."""
    found = [page for page in of_programs() if not (ROOT / page).exists()]
    for folder, below, names in os.walk(ROOT):
        place = pathlib.Path(folder).relative_to(ROOT)
        below[:] = sorted(d for d in below if not LEFT_OUT.search(d))
        found += [place / name for name in sorted(names) if name.endswith(".md")]
    return found


def title_of(page):
    found = re.search(r"^# (.*)", text_of(page), flags=re.M)
    return found[1].replace('"', "'") if found else page.stem


def target_of(page, link, there):
    """Returns (link within the site, file to be copied) of a relative link. (None, None) if it has no target."""
    path, _, anchor = link.partition("#")
    target = pathlib.Path(os.path.normpath(page.parent / path)) if path else page
    if (ROOT / target).is_dir():
        target /= "README.md"
        if target not in there:
            return (
                ("../" * (len(page.parts) - 1) + "gallery.md", None)
                if target == pathlib.Path("configs/README.md")
                else (None, None)
            )
    if target.parts[0] == ".." or target not in there and not (ROOT / target).is_file():
        return None, None
    site_link = os.path.relpath(target, page.parent) + (f"#{anchor}" if anchor else "")
    return site_link, None if target in there else target


def with_links(page, text, there, needed):
    """Text with links that work in the site; others are removed. Collects linked files in `needed`."""

    def link(match):
        mark, words, place = match.groups()
        if "://" in place or place.startswith("mailto:"):
            return match[0]
        found, file = target_of(page, place, there)
        if found is None:
            return words
        if file:
            needed.add(file)
            # Text files are displayed as text, regardless of their extension.
            found = found if file.suffix in (".png", ".svg", ".jpg", ".json", ".csv", ".html") else found + ".txt"
        return f"{mark}[{words}]({found})"

    parts = re.split(r"(^```.*?^```|`[^`\n]+`(?!\]))", text, flags=re.M | re.S)
    return "".join(
        part if i % 2 else re.sub(r"(!?)\[((?:[^][]|\[[^]]*\])*)\]\(([^)\s]+)\)", link, part)
        for i, part in enumerate(parts)
    )


LONG_CODE = 32  # characters of code from which a table may break it


def with_breaks(text):
    """Text whose tables may break long code, such as names of tests, after punctuation."""

    def broken(code):
        if len(code[1]) < LONG_CODE:
            return code[0]
        return "<code>" + re.sub(r"([._:/,])(?=.)", r"\1<wbr>", html.escape(code[1], quote=False)) + "</code>"

    text = re.sub(r"^\|.*", lambda row: re.sub(r"`([^`|]+)`", broken, row[0]), text, flags=re.M)
    # Tables of keys have six columns, which a narrow screen shows below each other (site.css).
    return re.sub(
        r"^\| key \| type \|.*\n(?:\|.*(?:\n|\Z))+",
        lambda table: f'<div class="keys" markdown="1">\n\n{table[0].rstrip()}\n\n</div>\n',
        text,
        flags=re.M,
    )


def duration(seconds):
    for unit, size, below in (("s", 1, 90), ("min", 60, 5400), ("h", 3600, math.inf)):
        if seconds < below:
            return f"{max(1, round(seconds / size))} {unit}"


def first_sentence(text):
    """Text up to the first full stop outside parentheses; "(Int. J. Numer. Meth.)" has none."""
    ends = (m.end() for m in re.finditer(r"[.!?](?= |$)", text))
    return next((text[:n] for n in ends if text.count("(", 0, n) == text.count(")", 0, n)), text)


def card(entry, there, needed):
    readme = pathlib.Path("configs") / entry.name / "README.md"
    picture = target_of(readme, entry.picture, there)[1] if entry.picture else None
    shown = ""
    if picture:
        needed.add(picture)
        shown = f"[![{entry.title}]({picture})]({readme})\n\n"
    title = f"[{entry.title}]({readme})" if readme in there else entry.title
    first = first_sentence(re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", entry.about))
    programs = ", ".join(f"`{p}`" for p in dict.fromkeys(entry.programs))
    cells = f"; {entry.cells} cells" if entry.cells else ""
    time = f"; about {duration(float(entry.seconds))} of one core" if entry.seconds else ""
    return (
        f'<div markdown="1">\n{shown}**{title}**\n\n{first}\n\n{programs}{cells}{time}\n\n'
        f'`couplet run configs/{entry.name}`\n\n</div>\n'
    )


def gallery(there, needed):
    text = "# Gallery\n\nExample cases. Copy one with `couplet new mine --from NAME`.\n\n"
    return (
        text
        + '<div class="gallery" markdown="1">\n\n'
        + "\n".join(card(e, there, needed) for e in entries())
        + "\n</div>\n"
    )


def label(page):
    """Title of a page in the sidebar, without the kind of its section."""
    title = re.sub(r"^Tutorial: ", "", title_of(page))
    return title[0].upper() + title[1:]


def is_for_users(page):
    """True for the pages that users read, except the READMEs of cases."""
    return str(page) in (*TUTORIALS, *REFERENCE, *EXPLANATION, *THEORY, "README.md", "docs/README.md") or page.parts[
        :2
    ] == ("docs", "how-to")


def is_generated(page):
    """True for pages that programs or scripts write as a whole."""
    return str(page) in GENERATED or page.parts[:2] == ("docs", "keys")


def for_developers(there):
    """Returns {title of a group: its pages}: what users do not need."""
    rest = [p for p in there if not is_for_users(p) and p.parts[0] != "configs"]
    groups = {"The project": [], "Validation": [], "Source folders": []}
    for page in rest:
        validation = page.parts[:2] == ("docs", "validation")
        groups["Validation" if validation else "Source folders" if page.name == "README.md" else "The project"].append(
            page
        )
    return groups


def nav_of(there):
    """Lines of the nav section."""

    def rows(names, indent, title=label):
        return [f'{" " * indent}- "{title(p)}": {p}' for p in map(pathlib.Path, names) if p in there]

    guides = sorted(p for p in there if p.parts[:2] == ("docs", "how-to"))
    guides.sort(key=lambda p: p.name != "README.md")
    lines = ["  - Couplet: index.md", "  - All pages: docs/README.md"]
    for title, names in (
        ("Tutorials", TUTORIALS),
        ("How-to", guides),
        ("Reference", REFERENCE),
        ("Explanation", EXPLANATION),
    ):
        lines += [f"  - {title}:", *rows(names, 4)]
    lines += [
        "    - Theory:",
        *rows(THEORY, 6),
        "  - Gallery:",
        "    - gallery.md",
        *rows([p for p in there if p.parts[0] == "configs"], 4),
        "  - For developers:",
    ]
    for title, names in for_developers(there).items():
        lines += (
            [f"    - {title}:", *rows(names, 6, (lambda p: str(p.parent)) if title == "Source folders" else label)]
            if names
            else []
        )
    return "\n".join(lines)


def leave_out(site, names):
    """Removes pages from the search, in the index that MkDocs wrote (the theme of Debian 12 cannot exclude pages)."""
    file = site / "search/search_index.json"
    index = json.loads(file.read_text())
    addresses = {str(p.with_name("index.html" if p.name == "README.md" else p.stem + ".html")) for p in names}
    index["docs"] = [entry for entry in index["docs"] if entry["location"].partition("#")[0] not in addresses]
    files.write(site, "search/search_index.json", json.dumps(index, separators=(",", ":")))


def with_formulas(page, text):
    """Text that loads MathJax if it has a formula."""
    up = "../" * (len(page.parts) - 1)
    return (
        text + f'\n\n<script async src="{up}mathjax/MathJax.js?config=TeX-AMS_CHTML-full"></script>\n'
        if re.search(r"\$[^$`\n]*[\\^_][^$`\n]*\$|^ *\$\$$", text, flags=re.M)
        else text
    )


def copy_mathjax(folder):
    for part in MATHJAX_PARTS:
        for file in (MATHJAX / part).rglob("*") if (MATHJAX / part).is_dir() else [MATHJAX / part]:
            if file.is_file():
                files.copy(file, folder, "mathjax" / file.relative_to(MATHJAX))


def stage(folder, with_plots):
    """Copies all sources of the site to a folder. Returns the nav."""
    there, needed = pages(), set()
    known = set(there)
    for page in there:
        text = with_breaks(with_links(page, with_formulas(page, text_of(page)), known, needed))
        text = plots.added(page, text, folder) if with_plots else text
        files.write(
            folder,
            "index.md" if str(page) == "README.md" else page,
            (
                text.replace("](README.md", "](index.md")
                if str(page) == "README.md"
                else re.sub(
                    r"\]\(((?:\.\./)+)README\.md(#[^)]*)?\)",
                    lambda m: (
                        f"]({m[1]}{'index.md' if m[1].count('../') == len(page.parts) - 1 else 'README.md'}"
                        f"{m[2] or ''})"
                    ),
                    text,
                )
            ),
        )
    files.write(folder, "gallery.md", gallery(known, needed))
    for file in needed:
        files.copy(
            ROOT / file,
            folder,
            (
                file
                if file.suffix in (".png", ".svg", ".jpg", ".json", ".csv", ".html")
                else file.with_name(file.name + ".txt")
            ),
        )
    files.copy(HERE / "site.css", folder)
    copy_mathjax(folder)
    return nav_of(there)


def build(site, with_plots=False):
    """Builds the site into a folder, with the plots of studies and of the maps of stability, which take minutes, if
    asked."""
    expect(
        shutil.which("mkdocs") and MATHJAX.is_dir(),
        "the site is built by MkDocs and MathJax: apt install mkdocs mkdocs-material libjs-mathjax",
    )
    site = pathlib.Path(site)
    with tempfile.TemporaryDirectory(prefix="couplet-site-") as scratch:
        docs, built = files.folder(scratch, "docs"), pathlib.Path(scratch) / "site"
        nav = stage(docs, with_plots)
        config = pathlib.Path(scratch) / "mkdocs.yml"
        text = (HERE / "mkdocs.yml").read_text()
        for name, value in (("docs", docs), ("site", built), ("nav", nav)):
            text = text.replace(f"{{{name}}}", str(value))
        files.write(scratch, config.name, text)
        done = subprocess.run(["mkdocs", "build", "--clean", "-f", config], capture_output=True, text=True)
        expect(done.returncode == 0, f"mkdocs failed: {(done.stderr or done.stdout).strip()[-2000:]}")
        leave_out(built, [page for group in for_developers(pages()).values() for page in group])
        for old in files.folder(site, ".").glob("[!.]*"):
            shutil.rmtree(old) if old.is_dir() and not old.is_symlink() else old.unlink()
        for file in filter(pathlib.Path.is_file, built.rglob("*")):
            files.copy(file, site, file.relative_to(built))
        return [line for line in (done.stdout + done.stderr).splitlines() if "WARNING" in line or "ERROR" in line]
