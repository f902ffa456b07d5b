# SPDX-License-Identifier: Apache-2.0
"""Where mutants are made. Left out is what decides how fast an answer is found but not which (preconditioners, coarse spaces),
what reads and writes files, and what is said to the user."""
import pathlib

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _of(folder, names):
    """The files of these names, wherever below the folder they lie."""
    there = {f.stem: f.relative_to(ROOT).as_posix() for f in sorted((ROOT / folder).rglob("*.cpp"))}
    return [there[name] for name in names.split()]


FILES = {
    "face loops": [
        *_of("fluid_solver", "rates face_flux predictor projection pressure boundary turbulence viscous_solver placement immersed "
                             "yielding_walls absorbing compression"),
        *_of("solid_solver", "heat heat_boundaries solid_fields stress finite_strain updated_lagrangian material_parameters mixed_form"),
        *_of("common/elasticity", "face_terms symmetric_faces symmetric_kernel symmetric_space elasticity least_squares_kernel "
                                  "shared_edges finite_edges finite_kernel anisotropic joined_vertices "
                                  "elastic_corrections vertex_constraints"),
        *_of("common/fv", "conduction gradients vertex_interpolation prescribed_motion"),
        *_of("mesh_mover", "laplacian pseudo_solid rotations patches mover"),
        *_of("thermocline", "bed_step packed_bed numerics grains layers shell surroundings"),
    ],
    "maps": [
        *_of("coupler", "mapping sparse_map transfer search cavity_wall links conjugate_map "
                        "face_weights slopes surface_rows"),
        *_of("common/modes", "modal_model surface_parts modal_checks"),
        *_of("plate_modal", "skin midsurface surface"),
    ],
    "ledgers": [
        *_of("solid_solver", "ledger"), *_of("coupler", "mechanics watch_integrals"), *_of("fluid_solver", "energy_guard"),
        *_of("plate_modal/diagnostics", "load mesh truncation"), *_of("thermocline", "tank report front_error"),
    ],
    "loads": [
        *_of("fluid_solver", "fractional_step rotation fluid"),
        *_of("common/elasticity", "space_kernel follower_pressure"),
        *_of("plate_modal", "pressure_load contact"),
        *_of("solid_solver", "thermal_strain solid_forces boundaries solid_body interface_data solid_interface"),
        *_of("coupler", "volume_level"), *_of("thermocline", "mechanics"),
    ],
    "scheme constants": [
        *_of("common/time", "time_scheme step_errors"),
        *_of("fluid_solver", "step_size"), *_of("solid_solver", "stage"),
        *_of("plate_modal", "oscillators kirchhoff plate_model"),
        *_of("coupler", "relaxation accelerator quasi_newton secants growing_qr explicit_coupling"),
        *_of("thermocline", "closures flow properties"),
    ],
}

# How many of the mutants a folder gets, in parts of all.
SHARES = {"fluid_solver": 42, "solid_solver": 40, "common/elasticity": 34, "common/fv": 18, "common/time": 14, "coupler": 34,
          "plate_modal": 20, "thermocline": 26, "mesh_mover": 12, "common/modes": 8}


def folder_of(file):
    """The program or the folder of common that a file belongs to, whatever its sub-folder."""
    return next((folder for folder in SHARES if file.startswith(folder + "/")), "")
