# SPDX-License-Identifier: Apache-2.0
"""Static, linear elastic solid of a case in a form for any finite element or finite volume program."""
import dataclasses

import numpy as np

from couplet.peers import elements, mesh
from couplet.peers.values import EVERYWHERE, field, number, only, refuse, settled, vector

HERE = EVERYWHERE | set("plane analysis kinematics material gravity solution-method time-scheme".split())
MATERIAL = set("density youngs-modulus poissons-ratio yield-strength conductivity specific-heat expansion".split())
PATCHES = {
    "free": set(),
    "fixed-displacement": {"value", "components", "traction"},
    "traction": {"value"},
    "pressure": {"value"},
    "force": {"value"},
    "symmetry": set(),
    "frictionless": set(),
}


@dataclasses.dataclass
class Solid:
    """Checked participant `name` of the sections `data`. Keys without a counterpart in `program` are rejected by name."""

    data: dict
    name: str
    folder: object
    work: object
    program: str
    trusted: bool = False

    def __post_init__(self):
        self.where, self.meshes = f"participants.{self.name}", {}
        self.section = s = self.data["participants"][self.name]
        settled(self.data)
        only(s, self.where, HERE, self.program)
        if s.get("analysis", "dynamic") != "static":
            refuse(
                f"{self.where}.analysis",
                f"'{s.get('analysis', 'dynamic')}' is not exported to {self.program}; only static is",
            )
        if s.get("kinematics", "small-strain") != "small-strain":
            refuse(
                f"{self.where}.kinematics",
                f"'{s['kinematics']}' is not exported to {self.program}; only small-strain is",
            )
        if not isinstance(s.get("material"), dict):
            refuse(f"{self.where}.material", "is needed")
        only(s["material"], f"{self.where}.material", MATERIAL, self.program)
        self.dimension, self.plane = int(s.get("dimension", 3)), s.get("plane", "strain")
        self.young, self.poisson, self.density = (
            number(s["material"].get(k, 0), f"{self.where}.material.{k}")
            for k in ("youngs-modulus", "poissons-ratio", "density")
        )
        self.time = number(self.data["simulation"]["end-time"], "simulation.end-time")
        for patch, given in self.boundaries.items():
            kind = given.get("type")
            if kind not in PATCHES:
                refuse(
                    f"{self.where}.boundaries.{patch}.type",
                    f"'{kind}' has no counterpart in {self.program}; only {', '.join(PATCHES)} have one",
                )
            only(given, f"{self.where}.boundaries.{patch}", PATCHES[kind] | {"type"}, self.program)

    @property
    def boundaries(self):
        return {p: g if isinstance(g, dict) else {"type": g} for p, g in (self.section.get("boundaries") or {}).items()}

    def mesh(self, order):
        """Mesh of first or second order, created once."""
        if order not in self.meshes:
            self.meshes[order] = mesh.of_participant(
                self.section, self.folder, self.where, self.work, order, self.trusted
            )
            mesh.check_patches(self.meshes[order], self.boundaries, self.where)
        return self.meshes[order]

    def gravity(self):
        g = [number(v, f"{self.where}.gravity") for v in self.section.get("gravity") or ()]
        return np.array(g + [0.0] * (3 - len(g)))

    def normal_axis(self, body, patch):
        """Axis 0, 1 or 2 normal to a symmetry plane. Other planes are rejected."""
        points = body.points[body.nodes_of(patch)]
        spread = np.ptp(points, axis=0)[: self.dimension]
        if spread.min() > 1e-9 * np.ptp(body.points, axis=0).max():
            refuse(
                f"{self.where}.boundaries.{patch}.type",
                "a symmetry plane that is not perpendicular to an axis is not exported",
            )
        return int(np.argmin(spread))

    def prescribed(self, body):
        """Returns {(node, axis): displacement [m]}."""
        found = {}
        for patch, given in self.boundaries.items():
            where, nodes = f"{self.where}.boundaries.{patch}", body.nodes_of(patch)
            if given["type"] in ("symmetry", "frictionless"):
                found.update({(n, self.normal_axis(body, patch)): 0.0 for n in nodes})
            elif given["type"] == "fixed-displacement":
                components = given.get("components") or dict(zip("xyz", given.get("value") or [0] * self.dimension))
                for axis, value in components.items():
                    values = field(value, f"{where}.{axis}", body.points[nodes], self.time)
                    found.update({(n, "xyz".index(axis)): v for n, v in zip(nodes, values)})
        return found

    def traction(self, patch, points, outward, area):
        """Traction (n, 3) at points of a patch with outward unit normals. `area` is that of the whole patch."""
        given, where = self.boundaries[patch], f"{self.where}.boundaries.{patch}"
        kind = given["type"]
        if kind == "pressure":
            return -field(given.get("value", 0), f"{where}.value", points, self.time)[:, None] * outward
        if kind in ("traction", "force"):
            return vector(given.get("value"), f"{where}.value", points, self.time, self.dimension) / (
                area if kind == "force" else 1
            )
        if kind == "fixed-displacement" and given.get("traction"):
            return vector(given["traction"], f"{where}.traction", points, self.time, self.dimension)
        return None

    def forces(self, body):
        """Work-equivalent nodal forces (points, 3) of all tractions; for a plane body per meter of depth."""
        found = np.zeros((len(body.points), 3))
        for patch in self.boundaries:
            area = sum(np.sum(q[2]) for q in self.integrals(body, patch))
            for faces, places, measure, outward, N in self.integrals(body, patch):
                pulled = self.traction(patch, places.reshape(-1, 3), outward.reshape(-1, 3), area)
                if pulled is None:
                    break
                shares = np.einsum("fq,fqc,qn->fnc", measure, pulled.reshape(places.shape), N)
                np.add.at(found, faces.ravel(), shares.reshape(-1, 3))
        return found

    def integrals(self, body, patch):
        """Yields (faces, positions (f, q, 3), measure (f, q), outward unit normals (f, q, 3), shape functions (q, points)) of each shape."""
        sides = body.outward(patch)
        for shape, faces in body.patches[patch].items():
            at, weight = elements.quadrature(shape)
            N, dN = elements.shape_functions(shape, body.order, at), elements.derivatives(shape, body.order, at)
            points = body.points[faces]
            places = np.einsum("qn,fnc->fqc", N, points)
            along = np.einsum("qdn,fnc->fqdc", dN, points)
            normal = (
                np.cross(along[:, :, 0], along[:, :, 1])
                if shape != "line"
                else np.stack([along[:, :, 0, 1], -along[:, :, 0, 0], 0 * along[:, :, 0, 0]], axis=-1)
            )
            size = np.linalg.norm(normal, axis=2)
            yield faces, places, size * weight, normal / size[:, :, None] * sides[shape][:, None, None], N
