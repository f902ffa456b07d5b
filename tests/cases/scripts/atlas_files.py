# SPDX-License-Identifier: Apache-2.0
"""Every map of the atlas makes its cases of files that are there: a square of each panel up to the start of its programs, and its theory."""
import pathlib
import re
import sys
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "scripts"), str(ROOT / "client/python"), str(ROOT / "tests/support")]
import atlas  # noqa: E402
from checks import check, end  # noqa: E402


class Recorder(atlas.Runner):
    """Starts nothing; what it would start is looked at."""
    started = 0

    def command(self, line, folder, limit=300):
        case = yaml.safe_load((folder / "case.yaml").read_text())
        meshes = [p["mesh"] for p in case["participants"].values() if "mesh" in p]
        self.started += bool(case["simulation"]["end-time"]) and all((folder / m).is_file() for m in meshes) and not re.search(r"\{\w+\}", str(case))
        return 1, False


with tempfile.TemporaryDirectory(prefix="couplet-atlas-") as scratch:
    for name, one in atlas.maps().items():
        runner = Recorder(ROOT / "build", scratch)
        for panel in one.every:
            one.run(panel, one.x["values"][0], one.y["values"][0], runner)
        check(name, runner.started == len(one.every), f"{runner.started} of {len(one.every)} panels")
        check(f"{name}: theory", all(len(xs) == len(ys) for *_, xs, ys in one.theory()))
end()
