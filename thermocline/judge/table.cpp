// SPDX-License-Identifier: Apache-2.0
#include "thermocline/judge/table.hpp"

#include "thermocline/model/tank.hpp"

namespace couplet::thermocline {
namespace {

/// Effects that the scene leaves out, and the error of the profile.
class TankFindings final : public diagnostics::Diagnostic {
 public:
  explicit TankFindings(const Tank& tank) : tank_(tank) {}
  void look(diagnostics::Report& report) override {
    for (diagnostics::Finding& f : tank_.effects()) {
      if (f.id == "resolved-grains")
        report.position.push_back({"Biot number of the grains", f.number, f.limit, "tank-biot"});
      report.findings.push_back(std::move(f));
    }
  }
  void conclude(diagnostics::Report& report) override { report.errors = tank_.error_parts(); }

 private:
  const Tank& tank_;
};

}  // namespace

void add_diagnostics(coupling::Participant& element, diagnostics::Diagnostics& all) {
  if (const auto* tank = dynamic_cast<const Tank*>(&element))
    all.add("tank", std::make_shared<TankFindings>(*tank));
}

}  // namespace couplet::thermocline
