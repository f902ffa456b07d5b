# SPDX-License-Identifier: Apache-2.0
"""The participant shown in docs/how-to/own-solver-cpp.md is the one that is built and tested, and takes less than 80 lines."""
import pathlib
import sys

root = pathlib.Path(sys.argv[1])
docs = (root / "docs/how-to/own-solver-cpp.md").read_text(encoding="utf-8")
lines = 0
for name in ("spring.hpp", "spring_main.cpp"):
    code = (root / "tests/coupling/toy" / name).read_text(encoding="utf-8").split("\n", 1)[1].rstrip()
    lines += sum(1 for line in code.splitlines() if line.strip() and not line.startswith("//"))
    if code not in docs:
        sys.exit(f"docs/how-to/own-solver-cpp.md does not show {name} as it is: copy it again.")
if lines >= 80:
    sys.exit(f"the participant takes {lines} lines of code, less than 80 are promised")
print(f"{lines} lines of code, the same in docs/how-to/own-solver-cpp.md")
