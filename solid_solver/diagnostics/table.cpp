// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/energy_balance.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"

namespace couplet::solid {

using diagnostics::Made;

// Each is in the file of its subject; nullptr if not applicable.
Made linear_theory(const SolidView& view);
Made neglected_inertia(const SolidView& view);
Made limits_of_material(const SolidView& view);
Made effects_of_heat(const SolidView& view);
Made solid_error(const SolidView& view, std::shared_ptr<StrainEnergy> strain,
                 std::shared_ptr<Stability> stability);
Made quantities(const SolidView& view);
Made quantities(const HeatView& view);
Made stress_error(const SolidView& view);
Made heat_swing(const Heat& heat);
Made heat_storage(const Heat& heat);
Made impossible_temperature(const Heat& heat);
Made heat_error(const Heat& heat);

// Later diagnostics read earlier ones: energies read strains, stresses and quantities the displacement error.
void add_diagnostics(const SolidView& view, diagnostics::Diagnostics& all) {
  const bool is_dynamic = view.body.is_dynamic(), is_small = view.compares_gradients();
  const auto strain = is_small ? std::make_shared<StrainEnergy>(view) : nullptr;
  const auto stability = !is_small && !is_dynamic ? std::make_shared<Stability>(view) : nullptr;
  all.add("strain-energy", strain);
  all.add("linear-theory", linear_theory(view));
  all.add("energy-balance", is_dynamic ? std::make_shared<EnergyBalance>(view, strain) : nullptr);
  all.add("stability", stability);
  all.add("inertia", neglected_inertia(view));
  all.add("limits-of-material", limits_of_material(view));
  all.add("effects-of-heat", effects_of_heat(view));
  if (const Heat* heat = view.body.thermal() ? view.body.thermal()->heat() : nullptr) {
    all.add("heat-swing", heat_swing(*heat));
    all.add("heat-storage", heat_storage(*heat));
    all.add("impossible-temperature", impossible_temperature(*heat));
  }
  if (all.with_errors()) all.add("error", solid_error(view, strain, stability));
  all.add("quantities", quantities(view));
  if (all.with_errors()) all.add("stress-error", stress_error(view));
}

void add_diagnostics(const HeatView& view, diagnostics::Diagnostics& all) {
  all.add("heat-swing", heat_swing(view.heat));
  all.add("heat-storage", heat_storage(view.heat));
  all.add("impossible-temperature", impossible_temperature(view.heat));
  if (all.with_errors()) all.add("error", heat_error(view.heat));
  all.add("quantities", quantities(view));
}

}  // namespace couplet::solid
