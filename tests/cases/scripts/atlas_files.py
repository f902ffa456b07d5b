# SPDX-License-Identifier: Apache-2.0
"""Every map of the atlas makes its cases of files that are there: a square of each panel up to the start of its programs."""
import pathlib
import sys
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "client/python"), str(ROOT / "tests/support")]
from checks import check, end  # noqa: E402
from couplet.atlas import atlas  # noqa: E402
from couplet.atlas.main import MAPS  # noqa: E402


class Recorder(atlas.Runner):
    """Starts nothing; what it would start is looked at."""
    started = 0

    def command(self, line, folder, files, limit=300):
        for file, text in files.items():
            (folder / file).write_text(text)
        case = yaml.safe_load((folder / "case.yaml").read_text())
        meshes = [p["mesh"] for p in case["participants"].values() if isinstance(p, dict) and "mesh" in p]
        self.started += bool(case["simulation"]) and all((folder / m).is_file() for m in meshes)
        return 1, False


with tempfile.TemporaryDirectory(prefix="couplet-atlas-") as scratch:
    for one in MAPS:
        for panel in one.panels:
            runner = Recorder(ROOT / "build", scratch + "/" + one.name + str(one.panels.index(panel)))
            try:
                one.run(panel, one.x.values[0], one.y.values[0], runner)
                problem = ""
            except (OSError, ValueError, KeyError) as error:
                problem = f"{type(error).__name__}: {error}"
            check(f"{one.name}, {panel}", runner.started > 0 and (not problem or "No such file" in problem and "/out/" in problem), problem)
end()
