// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "solid_solver/diagnostics/buckling.hpp"
#include "solid_solver/diagnostics/large_strain.hpp"
#include "solid_solver/diagnostics/stability.hpp"
#include "solid_solver/diagnostics/strain_energy.hpp"

namespace couplet::solid {
namespace {

using diagnostics::Made;
using diagnostics::When;

/// Solid and what several of its diagnostics share.
struct RunOfSolid {
  const SolidView& view;
  std::shared_ptr<StrainEnergy> strain;               ///< nullptr at large strain
  std::shared_ptr<Stability> stability;               ///< nullptr but in a static run at large strain
  const Heat* heat;                                   ///< nullptr unless temperatures are solved for
  std::shared_ptr<LinearBuckling> buckling{};         ///< nullptr at large strain
  std::shared_ptr<LargeStrainChange> large_strain{};  ///< nullptr at large strain
};

template <Made (*make)(const SolidView&)>
Made of_solid(const RunOfSolid& run) {
  return make(run.view);
}

template <Made (*make)(const Heat&)>
Made of_heat(const RunOfSolid& run) {
  return run.heat ? make(*run.heat) : nullptr;
}

Made energy_balance(const RunOfSolid& run) {
  return run.view.body.is_dynamic() ? std::make_shared<EnergyBalance>(run.view, run.strain) : nullptr;
}

Made linear_theory_of(const RunOfSolid& run) {
  return run.buckling ? linear_theory(run.view, run.large_strain, run.buckling) : nullptr;
}

// Later ones read earlier ones: energies read strains, stresses and quantities the displacement error.
using SolidRow = diagnostics::TableRow<RunOfSolid>;
constexpr std::array table{
    SolidRow{"strain-energy", When::always, [](const RunOfSolid& run) -> Made { return run.strain; }},
    SolidRow{"buckling", When::always, [](const RunOfSolid& run) -> Made { return run.buckling; }},
    SolidRow{"large-strain", When::always, [](const RunOfSolid& run) -> Made { return run.large_strain; }},
    SolidRow{"linear-theory", When::always, linear_theory_of},
    SolidRow{"energy-balance", When::always, energy_balance},
    SolidRow{"stability", When::always, [](const RunOfSolid& run) -> Made { return run.stability; }},
    SolidRow{"inertia", When::always, of_solid<neglected_inertia>},
    SolidRow{"limits-of-material", When::always, of_solid<limits_of_material>},
    SolidRow{"effects-of-heat", When::always, of_solid<effects_of_heat>},
    SolidRow{"missing-contact", When::always, of_solid<missing_contact>},
    SolidRow{"weight", When::always,
             [](const RunOfSolid& run) { return neglected_weight(run.view, run.strain); }},
    SolidRow{"heat-swing", When::always, of_heat<heat_swing>},
    SolidRow{"heat-storage", When::always, of_heat<heat_storage>},
    SolidRow{"impossible-temperature", When::always, of_heat<impossible_temperature>},
    SolidRow{"error", When::with_errors,
             [](const RunOfSolid& run) { return solid_error(run.view, run.strain); }},
    SolidRow{"quantities", When::always, of_solid<quantities>},
    SolidRow{"stress-error", When::with_errors, of_solid<stress_error>}};

using HeatRow = diagnostics::TableRow<HeatView>;
constexpr std::array table_of_heat{
    HeatRow{"heat-swing", When::always, [](const HeatView& view) { return heat_swing(view.heat); }},
    HeatRow{"heat-storage", When::always, [](const HeatView& view) { return heat_storage(view.heat); }},
    HeatRow{"impossible-temperature", When::always,
            [](const HeatView& view) { return impossible_temperature(view.heat); }},
    HeatRow{"error", When::with_errors, [](const HeatView& view) { return heat_error(view.heat); }},
    HeatRow{"quantities", When::always, quantities}};

}  // namespace

void add_diagnostics(const SolidView& view, diagnostics::Diagnostics& all) {
  const bool is_small = !view.body.large_strain(), is_static = !view.body.is_dynamic();
  RunOfSolid run{view, is_small ? std::make_shared<StrainEnergy>(view) : nullptr,
                 !is_small && is_static ? std::make_shared<Stability>(view, all.is_full()) : nullptr,
                 view.body.temperature() ? view.body.temperature()->heat() : nullptr};
  if (!has_finite_strain(view.body.parameters())) {
    run.buckling = std::make_shared<LinearBuckling>(view, all.is_full());
    run.large_strain = std::make_shared<LargeStrainChange>(view);
  }
  all.add(std::span<const SolidRow>(table), run);
}

void add_diagnostics(const HeatView& view, diagnostics::Diagnostics& all) {
  all.add(std::span<const HeatRow>(table_of_heat), view);
}

}  // namespace couplet::solid
