#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The rules that make mutants: what of a source they break, what they leave alone, and that names stay while statements do.
Usage: mutant_rules.py ROOT"""
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(sys.argv[1]).resolve()
sys.path.insert(0, str(ROOT / "tests/mutants"))
import generate  # noqa: E402
import rules  # noqa: E402

SOURCE = '''// a + b in a comment
#include "a.hpp"
namespace couplet {
constexpr double weight = 0.25;
class Loads;
/// sum += 2 * x;
double Loads::of(const Mesh& mesh, double h) const {
  double sum = 0;
  for (Index f = 0; f < mesh.n_interior; ++f) {
    const Index p = mesh.owner[f + 1];
    sum += 0.5 * h * value_[mesh.neighbour[f]];
  }
  if (sum > h + 1 && is_wide_) return 0;
  if (sum < h) throw Error("a + b: {} - {}", sum + h, h - 1);
  return -weight * sum + h * h;
}
}  // namespace couplet
'''
WANTED = {  # rule: what a line reads then
    "sign": {"if (sum > h - 1 && is_wide_) return 0;", "sum -= 0.5 * h * value_[mesh.neighbour[f]];", "return weight * sum + h * h;", "return -weight * sum - h * h;"},
    "factor": {"constexpr double weight = (0.25 * 2);", "constexpr double weight = (0.25 * 0.9);",
               "sum += (0.5 * 2) * h * value_[mesh.neighbour[f]];", "sum += (0.5 * 0.9) * h * value_[mesh.neighbour[f]];",
               "sum += 2 * (0.5 * h * value_[mesh.neighbour[f]]);", "sum += 0.9 * (0.5 * h * value_[mesh.neighbour[f]]);",
               "return 2 * (-weight * sum + h * h);", "return 0.9 * (-weight * sum + h * h);"},
    "dropped term": {";", "return -weight * sum;"},
    "off by one": {"for (Index f = 1; f < mesh.n_interior; ++f) {", "for (Index f = 0; f < mesh.n_interior - 1; ++f) {"},
    "comparison": {"if (sum >= h + 1 && is_wide_) return 0;"},
    "swapped sides": {"const Index p = mesh.neighbour[f + 1];", "sum += 0.5 * h * value_[mesh.owner[f]];"},
}

CHOICES = {  # what stands in a build that holds all mutants
    "const double weight = (ON ? 0.25 * 2 : 0.25);",
    "sum += (ON ? -1 : 1) * (0.5 * h * value_[mesh.neighbour[f]]);", "if (!ON) sum += 0.5 * h * value_[mesh.neighbour[f]];",
    "return (ON ? 1 : -1) * weight * sum + h * h;", "return -weight * sum + (ON ? 0 : 1) * (h * h);",
    "return (ON ? 0.9 : 1.0) * (-weight * sum + h * h);", "for (Index f = 0; f < mesh.n_interior - (ON ? 1 : 0); ++f) {",
    "const Index p = (ON ? mesh.neighbour : mesh.owner)[f + 1];", "if ((ON ? sum >= h + 1  : sum > h + 1 )&& is_wide_) return 0;"}


def made(text):
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "a.cpp").write_text(text)
        return generate.of_file(pathlib.Path(folder), "a.cpp")


def main():
    wrong, found = [], made(SOURCE)
    got = {rule: {m.shown for m in found if m.rule == rule} for rule in rules.NAMES}
    for rule, lines in got.items():
        wanted = WANTED.get(rule, set())
        wrong += [f"{rule}: not made: {line}" for line in wanted - lines] + [f"{rule}: made: {line}" for line in lines - wanted]
    chosen = set()
    for m in found:
        text = SOURCE
        for begin, end, new in sorted(m.choice or (), reverse=True):
            text = text[:begin] + new + text[end:]
        chosen.update(line.strip() for line in text.splitlines())
    wrong += [f"no choice: {line}" for line in CHOICES - chosen]
    names = [m.name for m in found]
    if len(set(names)) != len(names):
        wrong.append("two mutants have one name")
    # A statement that is put in front moves places and leaves names alone; one that is changed gets other ones.
    moved = {m.name for m in made(SOURCE.replace("  double sum = 0;\n", "  h = h * 3.5;\n  double sum = 0;\n"))}
    if not set(names) < moved:
        wrong.append("names change with what is written elsewhere")
    changed = {m.name for m in made(SOURCE.replace("0.5 * h", "0.4 * h"))}
    line = SOURCE[:SOURCE.index("0.5 * h")].count("\n") + 1
    if any((m.name in changed) != (m.line != line) for m in found):
        wrong.append("names go with their statements no longer")
    whole, half = generate.sample(ROOT, 60), generate.sample(ROOT, 60, "another")
    if [m.name for m in whole] != [m.name for m in generate.sample(ROOT, 60)] or {m.name for m in whole} == {m.name for m in half}:
        wrong.append("the seed does not decide what is drawn")
    for line in wrong:
        print(line)
    print(f"{len(found)} mutants of a sample of code, {len(wrong)} of the claims fail")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
