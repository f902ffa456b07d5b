# SPDX-License-Identifier: Apache-2.0
"""Elements of an XML file with their lines, and the treatment of each element of preCICE's configuration."""
import re
import xml.parsers.expat

from couplet.runs.case import CONTROL, expect

BLANKS = re.compile("[ \t-\r]")
LARGEST = 4 << 20  # bytes; configurations have a few thousand


class Element:
    def __init__(self, name, attributes, line):
        self.name, self.attributes, self.line, self.children = name, attributes, line, []

    def get(self, key, otherwise=""):
        return self.attributes.get(key, otherwise)

    def all(self, *names):
        return [c for c in self.children if c.name in names]

    def one(self, name):
        return next(iter(self.all(name)), None)

    def starting(self, *words):
        return [c for c in self.children if c.name.startswith(words)]

    def walk(self):
        yield self
        for child in self.children:
            yield from child.walk()


def read(file):
    """Reads the outermost element. Document types (and thus entities) are rejected."""
    expect(file.is_file(), f"{file}: this file does not exist.")
    data = file.read_bytes()
    expect(
        len(data) <= LARGEST, f"{file}: {len(data)} bytes are too many for a preCICE configuration (at most {LARGEST})."
    )
    parser, stack, roots = xml.parsers.expat.ParserCreate(), [], []

    def begin(name, attributes):
        element = Element(name, attributes, parser.CurrentLineNumber)
        (stack[-1].children if stack else roots).append(element)
        stack.append(element)
        expect(len(stack) < 64, f"{file}:{element.line}: elements are nested too deeply.")
        expect(
            not any(map(CONTROL.search, attributes.values())),
            f"{file}:{element.line}: <{name}> contains a control character; remove it.",
        )

    def document_type(*_):
        expect(False, f"{file}:{parser.CurrentLineNumber}: document types are not supported.")

    parser.StartElementHandler, parser.EndElementHandler = begin, lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = document_type
    try:
        parser.Parse(data, True)
    except xml.parsers.expat.ExpatError as error:
        expect(False, f"{file}:{error.lineno}: {xml.parsers.expat.errors.messages[error.code]}.")
    expect(
        roots[0].name == "precice-configuration",
        f"{file}:{roots[0].line}: expected <precice-configuration> of preCICE version 3, but found <{roots[0].name}>.",
    )
    return roots[0]


def digest(element):
    """Digest of names and attributes, as computed by the library (client/precice/xml.cpp) and compared by the coupler. It skips elements that do not
    affect the result."""
    value = 0xCBF29CE484222325
    for byte in "".join(_words(element)).encode():
        value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
    return f"xml-{value:016x}"


def _words(e):
    if e.name in ("log", "profiling") or e.name.startswith(("m2n:", "intra-comm:", "export:", "watch-")):
        return
    yield f"<{e.name}"
    for key, text in sorted(e.attributes.items()):
        yield f";{key}={BLANKS.sub('', text)}"
    for child in e.children:
        yield from _words(child)
    yield ">"


# Elements converted by configuration.py or read by the library (meshes, data, mappings), each with its attributes.
MAPS = "direction from to constraint"
RADIAL = MAPS + " polynomial x-dead y-dead z-dead shape-parameter support-radius solver-rtol"
MEASURE = "limit data mesh strict suffices"
MAPPED = {
    "precice-configuration": "experimental wait-in-finalize allow-remeshing",
    "data:scalar": "name waveform-degree",
    "data:vector": "name waveform-degree",
    "mesh": "name dimensions",
    "use-data": "name",
    "participant": "name control",
    "provide-mesh": "name",
    "receive-mesh": "name from safety-factor geometric-filter direct-access api-access",
    "write-data": "name mesh",
    "read-data": "name mesh",
    "exchange": "data mesh from to initialize substeps",
    "mapping:nearest-neighbor": MAPS,
    "mapping:nearest-projection": MAPS,
    "mapping:rbf": RADIAL,
    "mapping:rbf-global-direct": RADIAL,
    "mapping:rbf-global-iterative": RADIAL,
    "mapping:rbf-pum-direct": RADIAL + " vertices-per-cluster relative-overlap project-to-input",
    "coupling-scheme:serial-explicit": "",
    "coupling-scheme:parallel-explicit": "",
    "coupling-scheme:serial-implicit": "",
    "coupling-scheme:parallel-implicit": "",
    "coupling-scheme:multi": "",
    "participants": "first second",
    "max-time": "value",
    "max-time-windows": "value",
    "time-window-size": "value method",
    "max-iterations": "value",
    "min-iterations": "value",
    "relative-convergence-measure": MEASURE,
    "absolute-convergence-measure": MEASURE,
    "absolute-or-relative-convergence-measure": "abs-limit rel-limit data mesh strict suffices",
    "acceleration:constant": "",
    "acceleration:aitken": "",
    "acceleration:IQN-ILS": "reduced-time-grid",
    "acceleration:IQN-IMVJ": "reduced-time-grid always-build-jacobian",
    "relaxation": "value",
    "initial-relaxation": "value enforce",
    "max-used-iterations": "value",
    "time-windows-reused": "value",
    "filter": "type limit",
}
# Elements that do not affect the result and are not used.
SILENT = {"log", "sink", "profiling", "m2n:", "intra-comm:", "master:", "data", "executor:", "imvj-restart-mode"}
# Refused by the library itself.
SILENT |= {
    "mapping:nearest-neighbor-gradient",
    "mapping:axial-geometric-multiscale",
    "mapping:radial-geometric-multiscale",
    "use-mesh",
}
# Elements without influence on the answer, and their replacements.
WITHOUT_EFFECT = {
    "export:": "every program writes its own fields, and `coupling.watch` computes integrals",
    "watch-point": "points cannot be watched, but `coupling.watch` computes integrals",
    "watch-integral": "`coupling.watch` computes integrals over interfaces",
    "preconditioner": "data of several kinds are scaled once, by their initial magnitude",
    "basis-function:": "`projection` uses a local interpolant where a mesh has no faces",
}
# Elements that the library and the coupler do not support.
REFUSED = {
    "action:": "actions on data",
    "mapping:linear-cell-interpolation": "interpolation inside cells of a volume",
    "residual-relative-convergence-measure": "convergence against the first residual of a window",
    "min-iteration-convergence-measure": "a minimum number of iterations",
    "coupling-scheme:compositional": "schemes that are composed by hand",
    "acceleration:broyden": "Broyden's acceleration",
    "extrapolation-order": "extrapolation of preCICE version 2",
}


def listed(name, table):
    """Key of a table for an element, or None. A key that ends with a colon is a prefix."""
    if name in table:
        return name
    return next((key for key in table if key.endswith(":") and name.startswith(key)), None)
