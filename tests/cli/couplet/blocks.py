# SPDX-License-Identifier: Apache-2.0
"""Every block of commands, of YAML and of sample output in README.md, docs/, docs/how-to, docs/theory and docs/tutorials is run or checked, or is named
below with the reason. Commands and the samples after them are run by tutorials.py, page by page. A block of YAML is put into a shipped case, which
`couplet check` must then accept. Each line of another sample must be in the output of the command that is named here, with numbers within 2 %.
Usage: blocks.py BIN"""
import pathlib
import re
import shutil
import sys
import tempfile

import yaml

from scene import ROOT, call_here
from checks import check, end  # noqa: E402
from samples import is_said  # noqa: E402

bin_ = pathlib.Path(sys.argv[1])
OUTLINE = "an outline with gaps (...)"
SHIPPED = "a shipped case, which command_readmes runs by its own README"
NOT_RUN = {  # page: why no test runs its commands as they stand
    "README.md": "command_newcomer runs its second block; the first one takes half an hour, and CI runs it",
    "docs/quickstart.md": "command_newcomer and command_chroot run it",
    "docs/meshes.md": "the mesh tool has tests of its own, cut_mesh",
    "docs/plots.md": SHIPPED,
    "docs/studies.md": "needs CalculiX; the tests of peers run it",
    "docs/thermocline.md": SHIPPED,
    "docs/how-to/build-elsewhere.md": "builds; command_chroot_container runs the container's statements",
    "docs/how-to/cluster.md": "needs Slurm; command_slurm runs the lines that it has",
}
YAML = {  # page: for each block (case, section that the block is put into), or why it is not checked
    "docs/architecture.md": [OUTLINE],
    "docs/config.md": [OUTLINE],
    "docs/coupling.md": [("perpendicular-flap", "")],
    "docs/error-estimates.md": [("cook", "participants.solid"), "needs `analysis: thermal` in two dimensions; tests/cli/reported runs such a case"],
    "docs/expressions.md": ["one value in six ways"],
    "docs/large-strain.md": [("cantilever", ""), ("cantilever", "participants.solid"), ("lees-frame", "participants.solid")],
    "docs/mapping.md": [("perpendicular-flap", "")],
    "docs/plant.md": [("thermocline-andasol", "participants.tank")],
    "docs/plate.md": [("plate-square", "participants")],
    "docs/plots.md": ["every key of a picture at once; the pictures of the shipped cases use them"],
    "docs/precice.md": [OUTLINE, OUTLINE],
    "docs/studies.md": ["every key of a study at once; the committed studies use them", "a part of a study"],
    "docs/tutorial-solid.md": [("cantilever", "participants.solid"), ("eye-bar", "participants.solid")],
    "docs/how-to/boundary-conditions.md": [("cavity", "participants.fluid"), ("cantilever", "participants.solid")],
    "docs/how-to/choose-coupling.md": [("perpendicular-flap", "")],
    "docs/how-to/conjugate-heat.md": [("heated-plate", ""), ("hot-stream", ""), ("heated-plate", "")],
    "docs/how-to/drag-and-lift.md": [("cylinder", "")],
    "docs/how-to/exchange.md": [("thermocline-solar-one-wall", ""), ("perpendicular-flap", "")],
    "docs/how-to/heat-in-the-fluid.md": [("heated-cavity", "")],
    "docs/how-to/own-solver-python.md": [("spring-cylinder", "")],
    "docs/how-to/paraview.md": [("perpendicular-flap", "")],
    "docs/how-to/plate-for-solid.md": [("thin-plate", "participants"), ("thin-plate", "participants")],
    "docs/how-to/waveforms.md": [("windkessel-tube", "participants.fluid"), *[("pulsing-channel", "participants.fluid")] * 3],
    "docs/how-to/rigid-bodies.md": [("hinged-leaflet", "participants"), ("spring-cylinder", "participants"), "configs/hinged-leaflet/tumbling.yaml is this case"],
    "docs/theory/mesh-motion.md": [("perpendicular-flap", "participants.mover")],
    "docs/theory/solid-gradients.md": [("cantilever", "participants.solid")],
    "docs/theory/solid-motion.md": [("cantilever", "participants.solid")],
    "docs/theory/solid-solution.md": [("cantilever", "participants.solid")],
    "docs/theory/solid.md": [("cantilever", "participants.solid")],
}
INPUT, FORM = "an input file", "its words are under test where the message is made; the numbers are an example"
CANTILEVER = "run cantilever"
SAMPLES = {  # page: for each block of output that follows no commands: the command that gives it, or why no test compares it
    "docs/checkpoints.md": [FORM],
    "docs/effects.md": [FORM],
    "docs/error-estimates.md": [CANTILEVER, FORM, CANTILEVER, FORM, FORM, "run cook --set participants.solid.quantities={tip: {point: [48 mm, 60 mm], component: y}}", CANTILEVER],
    "docs/formats.md": ["a list of files"],
    "docs/glossary.md": [FORM],
    "docs/input-data.md": [INPUT, INPUT],
    "docs/large-strain.md": [FORM],
    "docs/plant.md": [INPUT],
    "docs/quantities.md": [FORM],
    "docs/studies.md": ["times differ by machine", "study cook --quantities", FORM],
    "docs/how-to/boundary-conditions.md": [INPUT],
}
NO_FIGURE = {"docs/how-to/README.md": "a list", "docs/how-to/build-elsewhere.md": "no results", "docs/how-to/cluster.md": "no results"}
MOST_BYTES = 4e6  # of all documents with their figures
FILES = {"seville.csv": "weather/granada_aldeire_surrogate.csv.gz"}  # which a block names, and what stands for them


def blocks(page, language):
    return re.findall(rf"^ *```{language}\n(.*?)^ *```", (ROOT / page).read_text(), flags=re.M | re.S)


def samples(page):
    """Blocks of output that follow no commands."""
    fenced = re.findall(r"^ *```(\w*)\n(.*?)^ *```", (ROOT / page).read_text(), flags=re.M | re.S)
    return [block for k, (language, block) in enumerate(fenced) if language == "text" and (k == 0 or fenced[k - 1][0] != "sh")]


def said_by(command, scratch):
    """Output of a command on a copy of the shipped case that it names."""
    word, name, *options = command.split(" ", 3)
    folder = pathlib.Path(tempfile.mkdtemp(dir=scratch)) / name
    shutil.copytree(ROOT / "configs" / name, folder, ignore=shutil.ignore_patterns("out", "out-*"))
    done = call_here(bin_, word, folder, *options)
    check(command, done.returncode == 0, done.stdout[-800:] + done.stderr[-800:] if done.returncode else "")
    return done.stdout + done.stderr


def joined(old, new):
    """Mapping with the keys of `new` in place of those of `old`. Another program, or another type, has other keys."""
    if not (isinstance(old, dict) and isinstance(new, dict)) or any(old.get(key, new.get(key)) != new.get(key, old.get(key)) for key in ("program", "type")):
        return new
    return {**old, **{key: joined(old.get(key), value) for key, value in new.items()}}


def checked(name, section, text, scratch):
    """(exit code, words) of `couplet check` of a case with a block of YAML in one of its sections."""
    folder = pathlib.Path(tempfile.mkdtemp(dir=scratch)) / name
    folder.mkdir()
    beside = [file for file in (ROOT / "configs" / name).iterdir() if file.name not in ("case.yaml", "out")]
    for link, file in [(folder / f.name, f) for f in beside] + [(folder / new, ROOT / "configs" / old) for new, old in FILES.items()]:
        link.symlink_to(file)
    for other in (ROOT / "configs").iterdir():
        if other.name != name:
            (folder.parent / other.name).symlink_to(other)
    new = yaml.safe_load(text)
    for key in reversed(section.split(".") if section else []):
        new = {key: new}
    case = joined(yaml.safe_load((ROOT / "configs" / name / "case.yaml").read_text()), new)
    for participant, told in (new.get("participants") or {}).items():
        if "boundaries" in told:  # the block's own patches and those of the case, whatever the mesh of the case calls them
            patches = "".join(f'Physical Surface("{patch}") = {{{k + 1}}};\n' for k, patch in enumerate(case["participants"][participant]["boundaries"]))
            (folder / "patches.geo").write_text(patches)
            case["participants"][participant] |= {"mesh": "patches.geo", "mesh-parameters": {}}
    (folder / "case.yaml").write_text(yaml.safe_dump(case, sort_keys=False))
    done = call_here(bin_, "check", folder)
    return done.returncode, done.stdout + done.stderr


pages = ["README.md", *sorted(str(f.relative_to(ROOT)) for part in ("", "how-to", "theory", "tutorials") for f in (ROOT / "docs" / part).glob("*.md"))]
run = {f"docs/{page}.md" for page in re.findall(r"(?:tutorials|how-to)/[\w-]+|tutorial-solid", (pathlib.Path(__file__).parent / "CMakeLists.txt").read_text())}
with_commands = {page for page in pages if blocks(page, "sh")}
check("a test runs the commands of each page, or the page is named with the reason", with_commands <= run | set(NOT_RUN), with_commands - run - set(NOT_RUN))
check("no page is named that a test runs, or that has no commands", not set(NOT_RUN) & run and set(NOT_RUN) <= with_commands, (set(NOT_RUN) & run, set(NOT_RUN) - with_commands))
without = {page for page in pages if page.startswith(("docs/how-to/", "docs/tutorials/")) and not re.search(r"!\[.+\]\((.+\.png)\)", (ROOT / page).read_text())}
check("each guide and tutorial has a figure, or is named with the reason", without == set(NO_FIGURE), without ^ set(NO_FIGURE))
size = sum(f.stat().st_size for f in (ROOT / "docs").rglob("*") if f.is_file())
check("the documents stay small", size < MOST_BYTES, f"{size / 1e6:.2f} MB")
counts = {page: len(found) for page in pages if (found := blocks(page, "yaml"))}
check("each block of YAML has its case, or a reason", counts == {page: len(told) for page, told in YAML.items()},
      set(counts.items()) ^ {(page, len(told)) for page, told in YAML.items()})
told = {page: len(found) for page in pages if (found := samples(page))}
check("each sample of output has its command, or a reason", told == {page: len(of) for page, of in SAMPLES.items()}, set(told.items()) ^ {(page, len(of)) for page, of in SAMPLES.items()})
with tempfile.TemporaryDirectory(prefix="couplet-blocks-") as scratch:
    outputs = {}
    for page, told in SAMPLES.items():
        for command, sample in zip(told, samples(page)):
            if not command.startswith(("run ", "study ")):
                continue
            if command not in outputs:
                outputs[command] = said_by(command, scratch)
            for line in sample.splitlines():
                check(f"{page}: {line.strip()}", is_said(line, outputs[command]), [w for w in outputs[command].splitlines() if line.strip()[:12] in w])
    for page, told in YAML.items():
        for number, (where, text) in enumerate(zip(told, blocks(page, "yaml"))):
            if not isinstance(where, str):
                code, said = checked(*where, text, scratch)
                check(f"{page}, block {number + 1}, in {' '.join(where)}", code == 0, said[-1500:])
    code, said = checked("cantilever", "participants.solid", "material: {youngs-modulos: 1 MPa}", scratch)
    check("a wrong key would be found", code == 2 and "youngs-modulos" in said, said)
end()
