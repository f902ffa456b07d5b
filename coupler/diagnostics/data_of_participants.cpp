// SPDX-License-Identifier: Apache-2.0
#include "common/io/archive.hpp"
#include "coupler/diagnostics/data_guard.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

/// Faults of participants that no residual shows by its cause (see DataGuard).
class DataOfParticipants final : public CouplingDiagnostic {
 public:
  explicit DataOfParticipants(const CouplingView& view) : view_(view), guard_(view.comm, view.pass.sides()) {}
  void begin_step() override { guard_.start_step(); }
  void answered(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given) override {
    guard_.answered(side, taken, given);
  }
  void observe(diagnostics::Report& report) override {
    for (log::Finding& finding : guard_.accepted(view_.pass.given(), view_.dt))
      report.findings.push_back(std::move(finding));
  }
  std::string remark() const override { return guard_.silent(); }
  void visit(io::Archive& archive) override { guard_.visit(archive, view_.pass.sides()); }

 private:
  const CouplingView& view_;
  DataGuard guard_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> data_of_participants(const CouplingView& view) {
  return std::make_shared<DataOfParticipants>(view);
}

}  // namespace couplet::coupler
