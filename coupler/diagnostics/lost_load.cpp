// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

constexpr double limit = 0.02;

/// Forces at faces that no participant receives, relative to received ones: RMS over faces and steps.
class LostLoad final : public CouplingDiagnostic {
 public:
  explicit LostLoad(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      std::vector<Force> forces;
      for (const coupling::Interface::Datum& datum : sides[i].interface.gives) {
        if (datum.unit != "N" || datum.place != coupling::Interface::Place::faces) continue;
        const bool taken = std::ranges::any_of(view.pass.links().all(), [&](const Links::Link& link) {
          return link.giver == i && link.datum.name == datum.name;
        });
        forces.push_back({i, datum.name, taken});
      }
      // If none are received, the coupling does not act by forces.
      if (std::ranges::any_of(forces, &Force::taken) && !std::ranges::all_of(forces, &Force::taken))
        forces_.insert(forces_.end(), forces.begin(), forces.end());
    }
  }
  bool empty() const { return forces_.empty(); }
  void observe(diagnostics::Report& report) override {
    std::array<double, 2> size{};  // of the forces that nobody takes, and of those that somebody does
    for (const Force& force : forces_) {
      for (const double value : values_of(view_.pass.given()[force.giver], force.name))
        size[force.taken] += value * value;
    }
    MPI_Allreduce(MPI_IN_PLACE, size.data(), 2, MPI_DOUBLE, MPI_SUM, view_.comm);
    for (std::size_t k = 0; k < size.size(); ++k) squares_[k] += size[k];
    if (!(squares_[1] > 0)) return;
    const double lost = std::sqrt(squares_[0] / squares_[1]);
    if (auto finding = diagnostics::finding_of(
            {.effect = "viscous coupling load",
             .number = lost,
             .limit = limit,
             .what = fmt::format("fluid forces not taken / taken by the structure = {:.2g}", lost),
             .advice =
                 "let the structure take 'viscous-force' as well ('interface: {load: forces}' of a solid)",
             .left_out = false,
             .share = lost / (1 + lost)}))  // of all forces
      report.findings.push_back(std::move(*finding));
  }
  void visit(io::Archive& archive) override { archive.common("squares", squares_); }

 private:
  struct Force {
    std::size_t giver;
    std::string name;
    bool taken;
  };
  const CouplingView& view_;
  std::vector<Force> forces_;        // of sides of which one is not taken
  std::array<double, 2> squares_{};  // sums over the run
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> lost_load(const CouplingView& view) {
  auto made = std::make_shared<LostLoad>(view);
  return made->empty() ? nullptr : made;
}

}  // namespace couplet::coupler
