// SPDX-License-Identifier: Apache-2.0
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {

// Each makes a diagnostic; nullptr where it does not apply.
#define FINDING(about, id, meaning)
#define ESTIMATE(name, make) std::shared_ptr<CouplingDiagnostic> make(const CouplingView&);
#define DIAGNOSTIC ESTIMATE
#include "coupler/diagnostics/table.def"
#undef DIAGNOSTIC
#undef ESTIMATE

CouplingDiagnostics coupling_diagnostics(const CouplingView& view, diagnostics::Diagnostics& all) {
  CouplingDiagnostics list;
  const auto add = [&](const char* name, std::shared_ptr<CouplingDiagnostic> one) {
    if (!one) return;
    all.add(name, one);
    list.push_back(std::move(one));
  };
#define DIAGNOSTIC(name, make) add(name, make(view));
#define ESTIMATE(name, make) \
  if (all.with_errors()) add(name, make(view));
#include "coupler/diagnostics/table.def"
#undef DIAGNOSTIC
#undef ESTIMATE
#undef FINDING
  return list;
}

}  // namespace couplet::coupler
