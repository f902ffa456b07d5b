// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {

/// Makes a diagnostic; nullptr where it does not apply.
using Make = std::shared_ptr<CouplingDiagnostic>(const CouplingView&);
Make added_mass, coupling_error, data_of_participants, explicit_lag, iteration_growth, lost_load,
    interface_oscillation, interface_work, structure_at_rest, unconverged_step;

namespace {

struct Row {
  const char* name;
  Make* make;
  bool estimates = false;  ///< an error: not where estimates are switched off
};

constexpr std::array table{Row{"iteration-growth", iteration_growth},
                           Row{"added-mass", added_mass},
                           Row{"interface-oscillation", interface_oscillation},
                           Row{"interface-work", interface_work},
                           Row{"data", data_of_participants},
                           Row{"structure-at-rest", structure_at_rest},
                           Row{"unconverged-step", unconverged_step},
                           Row{"lost-load", lost_load},
                           Row{"coupling-error", coupling_error, true},
                           Row{"explicit-lag", explicit_lag, true}};

}  // namespace

CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all) {
  CouplingDiagnostics list;
  for (const Row& row : table)
    if (const auto one = row.estimates && !all.with_errors() ? nullptr : row.make(view)) {
      all.add(row.name, one);
      list.push_back(one);
    }
  return list;
}

}  // namespace couplet::coupler
