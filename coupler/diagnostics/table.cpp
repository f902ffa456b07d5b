// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

using diagnostics::When;
using CouplingRow = diagnostics::TableRow<CouplingView, std::shared_ptr<CouplingDiagnostic>>;

// In the order in which they are asked why a step failed.
constexpr std::array table{CouplingRow{"iteration-growth", When::always, iteration_growth},
                           CouplingRow{"added-mass", When::always, added_mass},
                           CouplingRow{"interface-oscillation", When::always, interface_oscillation},
                           CouplingRow{"interface-work", When::always, interface_work},
                           CouplingRow{"data", When::always, data_of_participants},
                           CouplingRow{"structure-at-rest", When::always, structure_at_rest},
                           CouplingRow{"unconverged-step", When::always, unconverged_step},
                           CouplingRow{"lost-load", When::always, lost_load},
                           CouplingRow{"coupling-error", When::with_errors, coupling_error}};

}  // namespace

CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all) {
  return all.add(std::span<const CouplingRow>(table), view);
}

}  // namespace couplet::coupler
