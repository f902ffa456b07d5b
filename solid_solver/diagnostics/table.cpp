// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"

namespace couplet::solid {

using diagnostics::Made;

// Each is in the file of its subject; nullptr if not applicable.
#define FINDING(about, id, meaning)
#define MADE(name, made)
#define DIAGNOSTIC(name, make) Made make(const SolidView& view);
#define ESTIMATE DIAGNOSTIC
#define HEAT(name, make) Made make(const Heat& heat);
#include "solid_solver/diagnostics/table.def"
#undef MADE
#undef DIAGNOSTIC
#undef ESTIMATE
#undef HEAT
Made quantities(const HeatView& view);
Made heat_error(const Heat& heat);
Made neglected_weight(const SolidView& view, const std::shared_ptr<StrainEnergy>& strain);
Made solid_error(const SolidView& view, std::shared_ptr<StrainEnergy> strain,
                 std::shared_ptr<Stability> stability);

void add_diagnostics(const SolidView& view, diagnostics::Diagnostics& all) {
  const bool is_dynamic = view.body.is_dynamic(), is_small = view.compares_gradients();
  const auto strain = is_small ? std::make_shared<StrainEnergy>(view) : nullptr;
  const auto stability = !is_small && !is_dynamic ? std::make_shared<Stability>(view) : nullptr;
  const auto balance = is_dynamic ? std::make_shared<EnergyBalance>(view, strain) : nullptr;
  const auto error = all.with_errors() ? solid_error(view, strain, stability) : nullptr;
  const Heat* heat = view.body.thermal() ? view.body.thermal()->heat() : nullptr;
#define MADE(name, made) all.add(name, made);
#define DIAGNOSTIC(name, make) all.add(name, make(view));
#define ESTIMATE(name, make) \
  if (all.with_errors()) all.add(name, make(view));
#define HEAT(name, make) \
  if (heat) all.add(name, make(*heat));
#include "solid_solver/diagnostics/table.def"
#undef MADE
#undef DIAGNOSTIC
#undef ESTIMATE
#undef HEAT
#undef FINDING
}

void add_diagnostics(const HeatView& view, diagnostics::Diagnostics& all) {
  all.add("heat-swing", heat_swing(view.heat));
  all.add("heat-storage", heat_storage(view.heat));
  all.add("impossible-temperature", impossible_temperature(view.heat));
  if (all.with_errors()) all.add("error", heat_error(view.heat));
  all.add("quantities", quantities(view));
}

}  // namespace couplet::solid
