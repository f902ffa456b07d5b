# SPDX-License-Identifier: Apache-2.0
"""The case that a configuration of preCICE asks for, what of it differs here (notes), and what is not supported (refusals), each
with its line."""
import ctypes
import math
import os
import pathlib
import re

from couplet import places
from couplet.precice.elements import MAPPED, REFUSED, SILENT, WITHOUT_EFFECT, digest, listed

KINDS = {"nearest-neighbor": ("nearest", 0), "nearest-projection": ("projection", 1), "rbf": ("projection", 1)}
MEASURES = ("relative-convergence-measure", "absolute-convergence-measure", "absolute-or-relative-convergence-measure")
ACCELERATIONS = {"constant": "constant", "aitken": "aitken", "IQN-ILS": "iqn-ils", "IQN-IMVJ": "iqn-ils"}


class Import:
    def __init__(self, root):
        self.root, self.notes, self.refusals, self.case = root, [], [], {}
        self.schemes = root.starting("coupling-scheme:")
        for element in root.walk():
            self._look_at(element)
        self.case["participants"] = {p.get("name"): {"program": "precice"} for p in root.all("participant")}
        self._names()
        if self.schemes:
            self._scheme()
        else:
            self._refuse(root, "there is no <coupling-scheme:...>")
        self._mapping()

    def _refuse(self, element, why):
        self.refusals.append((element.line, why))

    def _note(self, element, text):
        if text not in [t for _, t in self.notes]:
            self.notes.append((element.line, text))

    def _look_at(self, element):
        """Checks a single element."""
        name = element.name
        if key := listed(name, REFUSED):
            self._refuse(element, f"<{name}> ({REFUSED[key]}) is not supported")
        elif key := listed(name, WITHOUT_EFFECT):
            self._note(element, f"<{name}> has no effect here: {WITHOUT_EFFECT[key]}")
        elif name in MAPPED or name.startswith("mapping:rbf"):
            self._look_at_attributes(element)
        elif not listed(name, SILENT):
            self._refuse(element, f"<{name}> is not known")

    def _look_at_attributes(self, e):
        words = MAPPED[e.name if e.name in MAPPED else "mapping:rbf"].split()
        for key in e.attributes:
            if key not in words:
                self._refuse(
                    e,
                    f"<{e.name}>: the attribute '{key}' is not known"
                    + (f", only: {', '.join(words)}" if words else ""),
                )

    def ask_library(self, file):
        """Returns the parts of the configuration that the library would refuse at the start of its programs. Its rules are not repeated here."""
        places_of = [
            os.environ.get("COUPLET_PRECICE_LIBRARY", ""),
            *(places.build() / part / "libprecice.so.3" for part in ("precice/lib", "lib/couplet/precice/lib")),
        ]
        library = next((path for path in map(pathlib.Path, places_of) if path.is_file()), None)
        if library is None:
            return self._note(
                self.root,
                f"not checked by the library, which is not at {places_of[1]}: scripts/build release precice_couplet",
            )
        ask = ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL).couplet_precice_problem
        ask.restype = ctypes.c_char_p
        for name in self.case["participants"]:
            if problem := ask(os.fsencode(file), name.encode()).decode(errors="replace").removesuffix("."):
                line, _, why = problem.removeprefix(f"{file}:").partition(": ")
                self.refusals.append(
                    (int(line), why) if line.isdigit() else (self.root.line, problem.removeprefix(f"{file}: "))
                )

    def _names(self):
        """Checks for unknown names, and for data that are read but never exchanged, which would be zero."""
        data = [d.get("name") for d in self.root.starting("data:")]
        meshes, people = ([e.get("name") for e in self.root.all(kind)] for kind in ("mesh", "participant"))
        exchanges = [e for s in self.schemes for e in s.all("exchange")]
        named = [e for p in self.root.all("participant") for e in p.all("write-data", "read-data")]
        named = [(e, {"name": data, "mesh": meshes}) for e in named] + [
            (e, {"data": data, "mesh": meshes, "from": people, "to": people}) for e in exchanges
        ]
        named += [(m, {"data": data, "mesh": meshes}) for s in self.schemes for m in s.all(*MEASURES)]
        for element, known in named:
            for key, names in known.items():
                if element.get(key) not in ("", *names):
                    self._refuse(
                        element, f"<{element.name}>: the {key} '{element.get(key)}' is not one of: {', '.join(names)}"
                    )
        for p in self.root.all("participant"):
            for e in p.all("read-data"):
                if e.get("name") in data and not any(
                    (x.get("data"), x.get("to")) == (e.get("name"), p.get("name")) for x in exchanges
                ):
                    self._refuse(e, f"'{p.get('name')}' reads '{e.get('name')}', but no <exchange> delivers it")

    # -- the scheme ---------------------------------------------------------------------------------------------------
    def _scheme(self):
        first = self.schemes[0]
        kinds = {s.name.split(":")[1] for s in self.schemes}
        if len(kinds) > 1:
            self._refuse(
                self.schemes[1], f"schemes of several kinds together are not supported: {', '.join(sorted(kinds))}"
            )
        if len(self.schemes) > 1 and "implicit" in first.name:
            self._refuse(self.schemes[1], "several implicit schemes are not supported; <coupling-scheme:multi> is")
        implicit = "explicit" not in first.name
        order = "serial" if "serial" in first.name else "parallel"
        members = self._members()
        self.case["simulation"] = self._times()
        self.case["coupling"] = coupling = {
            "scheme": "implicit" if implicit else "explicit",
            "exchange": {"participants": members, "order": order, "digest": digest(self.root)},
        }
        if implicit:
            self._convergence(first, coupling)
            self._acceleration(first, coupling)
        else:
            # These programs cannot repeat a step.
            self.case["simulation"]["max-step-halvings"] = 0
        coupling["predictor"] = {"order": 0}

    def _members(self):
        """Participants in the order of a step: the first of a scheme before its second."""
        before, names = [], []
        for s in self.schemes:
            pair, list_ = s.one("participants"), [p.get("name") for p in s.all("participant")]
            if pair:
                list_ = [pair.get("first"), pair.get("second")]
                before.append(tuple(list_))
            names += [n for n in list_ if n not in names]
        ordered = []
        while len(ordered) < len(names):
            free = [n for n in names if n not in ordered and not any(b == n and a not in ordered for a, b in before)]
            if not free:
                self._refuse(self.schemes[-1], "the serial schemes have no common order of their participants")
                return names
            ordered.append(free[0])
        return ordered

    def _number(self, element, otherwise=None):
        return otherwise if element is None else self._finite(element, "value", otherwise)

    def _finite(self, element, key, otherwise=None):
        try:
            if math.isfinite(number := float(element.get(key))):
                return number
        except ValueError:
            pass
        self._refuse(element, f"<{element.name}>: '{element.get(key)}' is not a finite number")
        return otherwise

    def _times(self):
        sizes = {self._number(s.one("time-window-size")) for s in self.schemes}
        if len(sizes) > 1 or None in sizes:
            self._refuse(self.schemes[0], "one <time-window-size> is expected, the same in all schemes")
            return {}
        step, ends = sizes.pop(), []
        for s in self.schemes:
            windows, time = self._number(s.one("max-time-windows"), -1), self._number(s.one("max-time"), -1)
            ends += [e for e in (windows * step if windows > 0 else -1, time) if e > 0]
        if not ends:
            self._refuse(self.schemes[0], "neither <max-time> nor <max-time-windows> states when the run ends")
        if step <= 0:
            self._refuse(self.schemes[0].one("time-window-size"), f"a time window of {step:g} is not supported")
        end = min(ends, default=0)
        return {"end-time": f"{end:.15g} s", "time-step": f"{step:.15g} s"}

    def _convergence(self, scheme, coupling):
        measures, limits, absolute = scheme.all(*MEASURES), [], []
        for m in measures:
            kind = m.name.removesuffix("-convergence-measure")
            if kind != "absolute":
                limits.append(self._limit(m, "limit" if kind == "relative" else "rel-limit"))
            if kind != "relative":
                absolute.append(self._limit(m, "limit" if kind == "absolute" else "abs-limit"))
                self._note(m, f"<{m.name}> is evaluated as the root mean square over the vertices")
        if len(set(limits)) > 1 or len(set(absolute)) > 1:
            self._note(measures[0], "one limit, the strictest, applies to all data that are iterated")
        if not measures:
            self._note(
                scheme,
                (
                    "without a convergence measure, each window takes max-iterations iterations and is accepted"
                    " unconverged"
                ),
            )
            self.case["simulation"]["accept"] = ["error-estimate", "unconverged-step"]
        coupling["convergence"] = {"relative": min(limits, default=1e-14)}
        if absolute and limits and any(not m.name.startswith("absolute-or") for m in measures):
            self._note(measures[0], "if relative and absolute limits are given, the relative one applies")
        elif absolute:
            coupling["convergence"]["absolute"] = f"{min(absolute):g} m"
        if (most := self._count(scheme.one("max-iterations"))) is not None:
            coupling["convergence"] |= {"max-iterations": most, "at-max-iterations": "accept"}
        else:
            self._note(scheme, "without max-iterations, a window ends after 10000 iterations")
            coupling["convergence"]["max-iterations"] = 10000
        if (least := self._count(scheme.one("min-iterations"))) is not None and least > 1:
            self._note(scheme, "min-iterations has no effect: a window ends when it has converged")

    def _limit(self, measure, key):
        """Limit of a convergence measure, with preCICE's default if both kinds are in one."""
        word = measure.get(key, {"rel-limit": "1e-5", "abs-limit": "1e-12"}.get(key, ""))
        try:
            if 0 < float(word) < math.inf:
                return float(word)
        except ValueError:
            pass
        self._refuse(measure, f"<{measure.name}>: the {key} '{word}' is not a number above 0")
        return 1

    def _count(self, element):
        """Number of iterations, or None without such an element."""
        if element is None:
            return None
        if re.fullmatch("[0-9]{1,5}", element.get("value")) and 1 <= int(element.get("value")) <= 10000:
            return int(element.get("value"))
        self._refuse(
            element,
            f"<{element.name}>: '{element.get('value')}' is not supported; expected a whole number from 1 to 10000",
        )
        return None

    def _acceleration(self, scheme, coupling):
        found = scheme.starting("acceleration:")
        if not found:
            coupling["acceleration"] = {"type": "constant", "initial-relaxation": 1}
            return
        a = found[0]
        kind = a.name.split(":")[1]
        values = {"type": ACCELERATIONS.get(kind, kind)}
        for element, key, whole in (
            ("relaxation", "initial-relaxation", False),
            ("initial-relaxation", "initial-relaxation", False),
            ("time-windows-reused", "reused-steps", True),
        ):
            if (e := a.one(element)) and (number := self._number(e)) is not None:
                values[key] = int(number) if whole else number
        if (m := a.one("max-used-iterations")) and self._number(m) is not None:
            self._note(m, "<max-used-iterations> has no effect: at most 100 differences are kept")
        if (f := a.one("filter")) and f.get("limit"):
            values["filter"] = self._finite(f, "limit")
            if f.get("type") != "QR2":
                self._note(f, f"the filter {f.get('type')} is taken as QR2: a column goes by its own size")
        if kind == "IQN-IMVJ":
            self._note(a, "IQN-ILS replaces IQN-IMVJ, because it needs fewer iterations here")
        coupling["acceleration"] = values

    # -- maps ---------------------------------------------------------------------------------------------------------
    def _mapping(self):
        kinds = {}
        for p in self.root.all("participant"):
            for m in p.starting("mapping:"):
                for word, kind in KINDS.items():
                    if m.name.split(":")[1].startswith(word) and not listed(m.name, REFUSED):
                        kinds[kind] = m
        if not kinds:
            return
        kind = max(kinds, key=lambda k: k[1])
        if len(kinds) > 1:
            self._note(kinds[kind], f"mappings of several kinds: all of them use '{kind[0]}'")
        self.case.setdefault("coupling", {})["mapping"] = {"type": kind[0]}
