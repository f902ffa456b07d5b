# SPDX-License-Identifier: Apache-2.0
"""Which quick tests are asked first about which sources: those named after the file, then those of its folder by their price."""
import re

from fields import folder_of

# Tests of a folder by their names, and those of others that say much of it.
FOLDER = {
    "fluid_solver": "(verification|stability|contract)_fluid.*|coupling_cavity|coupling_robin|coupling_string|flap_first_maximum_and_residuals",
    "solid_solver": "(verification|stability|contract|unit)_(solid|heat).*",
    "common/elasticity": "unit_(symmetric|elasticity|finite).*|verification_(solid|heat|mover).*",
    "common/fv": "unit_fv.*|verification_heat.*|verification_mover.*|verification_solid_(output|patch).*|verification_fluid_prescribed_motion",
    "common/time": "unit_time|verification_solid_(time_schemes|dynamics|energy|audit|spectrum)|verification_heat.*|verification_plate_(dynamics|guards)",
    "coupler": "unit_(conjugate_maps|coupler|maps|interface_map).*|coupl(ing|ed)_(?!plate|reed).*|contract_toys",
    "common/modes": "verification_solid_modes|verification_plate.*|coupling_plate_solid_modes",
    "plate_modal": "(verification|stability|contract)_plate.*|coupling_plate_restart_alone",
    "thermocline": "(unit|stability|contract|verification)_thermocline.*",
    "mesh_mover": "verification_mover.*|flap_first_maximum_and_residuals",
}


def tests_of(file, registered, price):
    """Names in the order in which they are asked. Those without a price come last."""
    folder, words = folder_of(file), set(re.split(r"[_/.]", file.split("/")[-1].removesuffix(".cpp")))
    found = [t for t in registered if re.fullmatch(FOLDER[folder], t) and not t.endswith("_long")]
    return sorted(found, key=lambda t: (not words & set(t.split("_")[2:]), price.get(t, 1e9), t))
