# SPDX-License-Identifier: Apache-2.0
"""Which namespace the headers of a folder stand in, after the table of docs/architecture.md. A namespace within it is fine (`couplet::log::detail`), and
so is a forward declaration of what another folder has (`namespace couplet::mesh { struct Mesh; }`)."""
import re

# The longest folder that a path begins with decides.
NAMESPACES = {
    "common/app": "couplet::app",
    "common/base": "couplet::base",
    "common/config": "couplet::config",
    "common/contact": "couplet::contact",
    "common/coupling": "couplet::coupling",
    "common/csv": "couplet::csv",
    "common/effects": "couplet::effects",
    "common/elasticity": "couplet::elastic",
    "common/fv": "couplet::fv",
    "common/io": "couplet::io",
    "common/linalg": "couplet::linalg",
    "common/log": "couplet::log",
    "common/mesh": "couplet::mesh",
    "common/modes": "couplet::modes",
    "common/parallel": "couplet::parallel",
    "common/time": "couplet::time",
    "solid_solver": "couplet::solid",
    "solid_solver/laws": "couplet::laws",
    "fluid_solver": "couplet::fluid",
    "mesh_mover": "couplet::mesh_mover",
    "plate_modal": "couplet::plate",
    "thermocline": "couplet::thermocline",
    "coupler": "couplet::coupler",
}
# Headers in `couplet` itself, and why.
EVERYBODYS = {
    "common/base/types.hpp": "Index, Vec3, Tensor3 stand in nearly every signature: a prefix would be read everywhere and tell nothing",
    "common/base/error.hpp": "Error is thrown by every folder and caught by main",
}


def wanted(path):
    """The namespace of a header of this path, or nothing where the table is silent (tests, client)."""
    if path in EVERYBODYS:
        return "couplet"
    fits = [folder for folder in NAMESPACES if path.startswith(folder + "/")]
    return NAMESPACES[max(fits, key=len)] if fits else None


def strangers(path, text):
    """(line, namespace) of each block of a header that stands in another namespace than the table wants."""
    want = wanted(path)
    if want is None or not path.endswith(".hpp"):
        return []
    found = []
    text = re.sub(r"//[^\n]*", "", text)
    for block in re.finditer(r"^namespace\s+(couplet[\w:]*)\s*\{", text, re.M):
        name, end, depth = block[1], block.end(), 1
        while depth and end < len(text):
            depth += {"{": 1, "}": -1}.get(text[end], 0)
            end += 1
        body = text[block.end():end - 1]
        own = name == want or name.startswith(want + "::")
        declared = re.fullmatch(r"\s*(?:(?:template\s*<[^;{}]*>\s*)?(?:class|struct|enum class)\s+\w+(?:\s*:\s*[\w:]+)?;\s*)+", body)
        if not own and not declared:
            found.append((text.count("\n", 0, block.start()) + 1, name))
    return found


def check_namespaces(path, text):
    return [f"{path}:{line}: namespace {name}: {path} stands in {wanted(path)} (tests/architecture/namespaces.py)" for line, name in strangers(path, text)]
