# SPDX-License-Identifier: Apache-2.0
"""Sub-folders of programs and of common, from the bottom to the top: a file includes from its own floor and from those below, so
that no circle can arise. "." is the folder itself: in a program it stands on top, in common mostly at the bottom. What the other
folders may include stands in check_sources.py."""

MOST_FILES = 25  # .cpp and .hpp of one folder, tests apart

FLOORS = {
    "solid_solver": ["laws", "material", "parameters", "boundary", "contact", "method", "large_strain", "effects", "thermal", "body", "motion", "stability", "judge",
                     "output", "."],
    "fluid_solver": ["conditions", "parameters", "state", "lines", "boundary", "turbulence", "motion", "pressure", "momentum", "step", "judge", "output", "."],
    "coupler": ["parameters", "exchange", "mapping", "acceleration", "judge", "output", "."],
    "thermocline": ["material", "weather", "plant", "bed", "wall", "model", "judge", "."],
    "mesh_mover": [".", "barrier"],
    "plate_modal": ["model", "motion", "."],
    "common/elasticity": [".", "thesis", "symmetric", "axisymmetric", "prestress", "tied", "finite", "solve"],
    "common/mesh": [".", "order", "distributed", "msh", "inp", "gmsh"],
    "common/app": ["watch", "loop", "case", ".", "mesh_tool"],
    "common/io": [".", "fields", "probes", "cut"],
    "common/linalg": ["lazy", "lanes", ".", "multigrid", "poisson"],
}

# Functions of a class above, written where their subject is.
UPWARDS = {
    ("mesh_mover/mover.cpp", "mesh_mover/barrier/barrier_motion.hpp"),  # makes the method
    ("fluid_solver/motion/rotating_frame.cpp", "fluid_solver/step/fluid.hpp"),
    ("fluid_solver/motion/turning_walls.cpp", "fluid_solver/step/fluid.hpp"),
}


def _floor(path):
    """("coupler", "mapping") of coupler/mapping/mapping.hpp; nothing of a file outside the table."""
    for home in FLOORS:
        if path.startswith(home + "/"):
            rest = path[len(home) + 1:].split("/")
            return home, rest[0] if len(rest) > 1 else "."
    return None


def climbs(path, included):
    """Why this include goes upwards, or nothing."""
    here, there = _floor(path), _floor(included)
    if not here or not there or here[0] != there[0] or (path, included) in UPWARDS:
        return None
    order = FLOORS[here[0]]
    for home, floor in (here, there):
        if floor not in order:
            return f"{home}/{floor} has no place in tests/architecture/floors.py"
    return f"{here[0]}/{there[1]} stands above {here[1]}" if order.index(there[1]) > order.index(here[1]) else None


def crowded(paths):
    """Folders with more files than can be taken in at a glance. `paths`: of sources, relative to the project."""
    counts = {}
    for path in paths:
        if path.suffix in (".cpp", ".hpp") and path.parts[0] not in ("tests", "benchmarks", "configs"):
            counts[path.parent] = counts.get(path.parent, 0) + 1
    return [f"{folder}: {n} sources, at most {MOST_FILES} are allowed: make a sub-folder after what they do" for folder, n in sorted(counts.items())
            if n > MOST_FILES]
