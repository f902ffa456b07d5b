# SPDX-License-Identifier: Apache-2.0
"""Bars of the reed valve: mesh motion around thin bodies, the weakly compressible fluid."""
from validation.parts.reed.layer import LAYER
from validation.parts.reed.mesh import MESH
from validation.parts.reed.sound import SOUND_BARS
from validation.parts.reed.valve import VALVE

SOURCES = ("common/base", "common/parallel", "common/linalg", "common/mesh", "common/fv", "mesh_mover", "configs/passing-cylinders",
           "configs/moving-mesh", "tests/verification/mover")
BARS = [
    *MESH,
    *SOUND_BARS,
    *LAYER,
    *VALVE,
]
