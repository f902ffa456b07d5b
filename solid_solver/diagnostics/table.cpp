// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/energy_balance.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"

namespace couplet::solid {

using Made = std::shared_ptr<diagnostics::Diagnostic>;

// Each in the file of its subject; nullptr where it does not apply.
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
Made heat_error(const Heat& heat);

namespace {

void add(diagnostics::Diagnostics& all, const char* name, Made diagnostic) {
  if (diagnostic) all.add(name, std::move(diagnostic));
}

}  // namespace

// Of two the later one reads the earlier: the energies the strains, stresses and quantities the error of the displacement.
void add_diagnostics(const SolidView& view, diagnostics::Diagnostics& all) {
  const bool is_dynamic = view.body.is_dynamic(), is_small = view.compares_gradients();
  const auto strain = is_small ? std::make_shared<StrainEnergy>(view) : nullptr;
  const auto stability = !is_small && !is_dynamic ? std::make_shared<Stability>(view) : nullptr;
  add(all, "strain-energy", strain);
  add(all, "linear-theory", linear_theory(view));
  add(all, "energy-balance", is_dynamic ? std::make_shared<EnergyBalance>(view, strain) : nullptr);
  add(all, "stability", stability);
  add(all, "inertia", neglected_inertia(view));
  add(all, "limits-of-material", limits_of_material(view));
  add(all, "effects-of-heat", effects_of_heat(view));
  if (const Heat* heat = view.body.thermal() ? view.body.thermal()->heat() : nullptr) {
    add(all, "heat-swing", heat_swing(*heat));
    add(all, "heat-storage", heat_storage(*heat));
  }
  if (all.with_errors()) add(all, "error", solid_error(view, strain, stability));
  add(all, "quantities", quantities(view));
  if (all.with_errors()) add(all, "stress-error", stress_error(view));
}

void add_diagnostics(const HeatView& view, diagnostics::Diagnostics& all) {
  add(all, "heat-swing", heat_swing(view.heat));
  add(all, "heat-storage", heat_storage(view.heat));
  if (all.with_errors()) add(all, "error", heat_error(view.heat));
  add(all, "quantities", quantities(view));
}

}  // namespace couplet::solid
