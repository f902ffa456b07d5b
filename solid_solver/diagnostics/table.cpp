// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/table.hpp"

#include "solid_solver/diagnostics/effects.hpp"
#include "solid_solver/solid.hpp"
#include "solid_solver/thermal_solid.hpp"

namespace couplet::solid {
namespace {

/// Effects that the scene leaves out, by what the run has seen of them.
class Effects final : public diagnostics::Diagnostic {
 public:
  explicit Effects(const Solid& solid) : solid_(solid) {}
  void look(diagnostics::Report& report) override {
    for (diagnostics::Finding& f : effect_findings(solid_.body().parameters(), solid_.judge().evidence())) {
      if (f.id == "near-incompressibility")
        report.position.push_back({"Poisson's ratio", f.number, f.limit, "solid-nu"});
      report.findings.push_back(std::move(f));
    }
  }

 private:
  const Solid& solid_;
};

/// Error of the displacement, or of the temperature of a body that only conducts heat.
template <class Participant>
class Error final : public diagnostics::Diagnostic {
 public:
  explicit Error(Participant& solid) : solid_(solid) { solid.collect_errors(); }
  void conclude(diagnostics::Report& report) override { report.errors = solid_.error_parts(); }

 private:
  const Participant& solid_;
};

template <class Participant>
void add_error(Participant& solid, diagnostics::Diagnostics& all) {
  if (all.with_errors()) all.add("error", std::make_shared<Error<Participant>>(solid));
}

}  // namespace

void add_diagnostics(coupling::Participant& participant, diagnostics::Diagnostics& all) {
  if (auto* solid = dynamic_cast<Solid*>(&participant)) {
    all.add("effects", std::make_shared<Effects>(*solid));
    add_error(*solid, all);
  } else {
    add_error(dynamic_cast<ThermalSolid&>(participant), all);
  }
}

}  // namespace couplet::solid
