# SPDX-License-Identifier: Apache-2.0
"""Which quick tests are asked first about which sources: those of a file, then those of its folder by their price."""

from fields import folder_of

FILE = {
    "fluid_solver/step/energy_guard": "stability_fluid_energy_guard verification_fluid_sound",
    "fluid_solver/pressure/projection": "verification_fluid_steps",
    "fluid_solver/step/predictor": "verification_fluid_boundaries",
    "fluid_solver/step/step_size": "stability_fluid_step_sizes verification_fluid_steps",
    "fluid_solver/momentum/turbulence": "verification_fluid_effects",
    "fluid_solver/motion/immersed": "verification_fluid_effects",
    "fluid_solver/motion/rotation": "verification_fluid_turning_walls verification_fluid_rotating_frame",
    "fluid_solver/step/checks": "contract_fluid coupling_cavity",
    "fluid_solver/pressure/yielding_walls": "stability_fluid_light_wall coupling_robin coupling_string",
    "fluid_solver/step/fractional_step": "verification_fluid_exactness stability_fluid_light_wall verification_fluid_wall_output",
    "fluid_solver/boundary/boundary": "verification_fluid_boundaries",
    "solid_solver/thermal/heat": "verification_heat_exactness verification_heat_series verification_heat_errors verification_heat_order",
    "solid_solver/thermal/heat_boundaries": "verification_heat_exactness verification_heat_series",
    "solid_solver/thermal/thermal_strain": "verification_heat_strain verification_heat_stress",
    "solid_solver/motion/ledger": "verification_solid_energy verification_solid_audit",
    "solid_solver/equilibrium/finite_strain": "verification_solid_finite_strain verification_solid_finite_motion",
    "solid_solver/equilibrium/updated_lagrangian": "verification_solid_updated_lagrangian",
    "solid_solver/parameters/material_parameters": "verification_solid_orthotropic",
    "solid_solver/method/mixed_form": "verification_solid_mixed_form",
    "solid_solver/parameters/interface_data": "verification_solid_interface_data",
    "solid_solver/body/solid_interface": "verification_solid_contract contract_solid",
    "solid_solver/boundary/boundaries": "verification_solid_conditions",
    "solid_solver/motion/stage": "verification_solid_time_schemes verification_solid_dynamics verification_solid_energy",
    "common/elasticity/finite/finite_kernel": "verification_solid_finite_strain unit_finite_law verification_solid_conditions",
    "common/elasticity/finite/finite_edges": "verification_solid_finite_strain",
    "common/elasticity/symmetric/surface_pressure": "verification_solid_finite_strain verification_solid_conditions",
    "common/elasticity/joined_vertices": "verification_mover_periodic",
    "common/elasticity/anisotropic": "verification_solid_orthotropic",
    "common/elasticity/symmetric/shared_edges": "verification_solid_symmetric verification_heat_strain",
    "common/elasticity/elastic_kernel": "unit_symmetric_loads verification_heat_strain verification_solid_symmetric",
    "common/fv/conduction": "unit_fv_operators verification_heat_exactness",
    "common/fv/prescribed_motion": "unit_fv_operators verification_fluid_prescribed_motion",
    "common/fv/gradients": "unit_fv_operators verification_heat_exactness unit_fv_point_gradient verification_heat_strain",
    "common/fv/vertex_interpolation": "unit_fv_interpolation",
    "common/time": "unit_time verification_solid_time_schemes verification_solid_spectrum",
    "common/modes/modal_checks": "verification_plate_modes_file",
    "coupler/acceleration/volume_level": "coupling_volume_level coupling_cavity",
    "coupler/exchange/face_corners": "coupling_volume_level coupling_cavity",
    "coupler/diagnostics/explicit_coupling": "coupled_toy",
    "coupler/exchange/transfer": "unit_maps unit_interface_map",
    "coupler/mapping/mapping": "unit_coupler unit_maps unit_coupler_maps_3",
    "coupler/mapping/sparse_map": "unit_maps unit_coupler_maps_3",
    "coupler/mapping/conjugate_map": "unit_conjugate_maps unit_maps",
    "coupler/mapping/face_weights": "unit_maps unit_conjugate_maps",
    "coupler/mapping/surface_rows": "unit_conjugate_maps unit_maps",
    "coupler/output/watch_integrals": "unit_coupler_maps_3 coupling_exchange",
    "coupler/output/mechanics": "coupling_exchange coupling_piston",
    "plate_modal/motion/contact": "verification_plate_contact stability_plate_contact",
    "plate_modal/diagnostics": "verification_plate_guards verification_plate_resolution",
    "plate_modal/model/kirchhoff": "verification_plate_patch verification_plate_statics",
    "plate_modal/model/midsurface": "verification_plate_guards",
    "plate_modal/motion/oscillators": "verification_plate_contact verification_plate_dynamics",
    "plate_modal/motion/pressure_load": "verification_plate_resolution",
    "thermocline/wall/mechanics": "verification_thermocline_mechanics stability_thermocline",
    "thermocline/bed/bed_step": "verification_thermocline_bed",
    "thermocline/bed/grains": "verification_thermocline_grains",
    "thermocline/plant/report": "unit_thermocline_plant",
    "thermocline/bed/closures": "verification_thermocline_grains verification_thermocline_bed",
    "thermocline/material/properties": "verification_thermocline_conduction",
    "thermocline/wall/layers": "verification_thermocline_conduction",
    "thermocline/model/tank": "verification_thermocline_tank",
}

FOLDER = {
    "fluid_solver": "verification_fluid_face_loops verification_fluid_exactness verification_fluid_taylor_green verification_fluid_cavity verification_fluid_steps "
                    "verification_fluid_boundaries verification_fluid_prescribed_motion verification_fluid_wall_output verification_fluid_samples "
                    "verification_fluid_turning_walls verification_fluid_rotating_frame verification_fluid_gaps verification_fluid_effects "
                    "stability_fluid_step_sizes stability_fluid_energy_guard stability_fluid_light_wall stability_fluid_under_resolved contract_fluid "
                    "verification_fluid_exactness_3 flap_first_maximum_and_residuals",
    "solid_solver": "verification_solid_patch verification_solid_order verification_solid_cantilever verification_solid_dynamics "
                    "verification_solid_time_schemes verification_solid_energy verification_solid_step_control verification_solid_spectrum "
                    "verification_solid_contract unit_solid_parameters verification_solid_output verification_solid_conditions "
                    "verification_solid_materials verification_solid_methods verification_solid_closed_forms verification_solid_audit "
                    "verification_solid_modes verification_solid_symmetric verification_solid_beams verification_solid_slender "
                    "verification_solid_interface_data verification_solid_finite_strain verification_solid_finite_motion "
                    "verification_solid_updated_lagrangian verification_solid_orthotropic verification_solid_incompressible "
                    "verification_solid_large_strain_estimate verification_solid_volume_strain verification_solid_mixed_form "
                    "verification_heat_exactness verification_heat_errors verification_heat_order verification_heat_series verification_heat_strain "
                    "verification_heat_stress contract_solid stability_solid_hard_cases verification_solid_patch_3",
    "common/elasticity": "unit_symmetric_loads unit_elasticity_kernel unit_finite_law unit_symmetric_diagonal verification_solid_patch verification_solid_symmetric "
                         "verification_solid_methods verification_solid_order verification_solid_closed_forms verification_solid_conditions "
                         "verification_solid_materials verification_solid_incompressible verification_solid_mixed_form verification_solid_volume_strain "
                         "verification_solid_finite_strain verification_solid_updated_lagrangian verification_solid_orthotropic verification_solid_energy "
                         "verification_solid_audit verification_heat_strain verification_heat_stress verification_solid_contract verification_solid_beams "
                         "verification_solid_patch_3 verification_mover",
    "common/fv": "unit_fv_operators unit_fv_expression unit_fv_table unit_fv_interpolation unit_fv_point_gradient verification_heat_exactness verification_heat_order "
                 "verification_heat_series verification_heat_strain verification_solid_output verification_fluid_prescribed_motion verification_mover "
                 "verification_mover_motion verification_solid_patch verification_heat_errors verification_heat_exactness_3",
    "common/time": "unit_time verification_solid_time_schemes verification_solid_dynamics verification_solid_energy verification_solid_audit "
                   "verification_solid_spectrum verification_heat_order verification_heat_errors verification_plate_dynamics verification_plate_guards",
    "coupler": "unit_conjugate_maps unit_coupler unit_maps unit_coupler_maps unit_coupler_maps_3 unit_coupler_ranks unit_coupler_ranks_3 coupling_groups coupling_exchange "
               "coupled_toy coupling_volume_level coupling_added_mass unit_interface_map contract_toys coupling_piston coupling_string coupling_robin "
               "coupling_cavity coupled_toy_mpmd",
    "common/modes": "verification_solid_modes verification_plate_modes_file verification_plate_frequencies verification_plate_guards coupling_plate_solid_modes",
    "plate_modal": "verification_plate_patch verification_plate_frequencies verification_plate_statics verification_plate_dynamics verification_plate_contact "
                   "verification_plate_resolution verification_plate_guards verification_plate_effects verification_plate_modes_file "
                   "stability_plate_contact contract_plate coupling_plate_restart_alone",
    "thermocline": "unit_thermocline_plant stability_thermocline stability_thermocline_hard_cases contract_thermocline {verification_thermocline_}",
    "mesh_mover": "verification_mover verification_mover_motion verification_mover_ranks verification_mover_curved_slide verification_mover_periodic "
                  "verification_mover_periodic_3 flap_first_maximum_and_residuals",
}


def _named(words, registered):
    for word in words.split():
        if word.startswith("{"):
            yield from sorted(t for t in registered if t.startswith(word[1:-1]) and not t.endswith("_long"))
        else:
            yield word


def tests_of(file, registered, price):
    """Names in the order in which they are asked. Those that are not registered or have no price are left out."""
    stem, folder = file.removesuffix(".cpp"), folder_of(file)
    near = [t for key, words in FILE.items() if stem == key or folder == key for t in words.split()]
    rest = sorted(_named(FOLDER[folder], registered), key=lambda t: price.get(t, 1e9))
    return [t for t in dict.fromkeys([*near, *rest]) if t in registered]

