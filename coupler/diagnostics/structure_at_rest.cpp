// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

constexpr int patience = 10;  // steps

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Detects loaded structures that do not move at all, because their interface is held or the load does not
/// arrive. Even a stiff structure moves measurably.
class StructureAtRest final : public CouplingDiagnostic {
 public:
  explicit StructureAtRest(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t s = 0; s < sides.size(); ++s) {
      const coupling::Interface& i = sides[s].interface;
      if (!find_datum(i.gives, "displacement")) continue;
      Structure one{.side = s, .loads = {}, .unit = {}};
      for (const auto& datum : i.takes)
        if (datum.unit == "N" || datum.unit == "Pa") one.loads.push_back(datum.name), one.unit = datum.unit;
      if (!one.loads.empty()) structures_.push_back(std::move(one));
    }
    steps_.resize(structures_.size());
  }
  void observe(diagnostics::Report& report) override {
    for (std::size_t k = 0; k < structures_.size(); ++k) {
      const Structure& one = structures_[k];
      double load = 0;
      for (const std::string& name : one.loads)
        load = std::max(load, largest(values_of(view_.pass.taken()[one.side], name)));
      load = parallel::max(view_.comm, load);
      const double motion =
          parallel::max(view_.comm, largest(values_of(view_.pass.given()[one.side], "displacement")));
      steps_[k] = load > 0 && motion == 0 ? steps_[k] + 1 : 0;
      if (steps_[k] < patience) continue;
      const std::string& name = view_.pass.sides()[one.side].name;
      report.findings.push_back(
          {.id = "structure-at-rest",
           .sentence = fmt::format("motion of '{}': 0 m at every interface vertex for {} steps under a load "
                                   "of up to {:.3g} {} per face: the interface is held fixed; check its "
                                   "boundary conditions and `coupling`.",
                                   name, steps_[k], load, one.unit),
           .subject = name});
    }
  }
  void visit(io::Archive& archive) override { archive.common("steps", steps_); }

 private:
  struct Structure {
    std::size_t side;
    std::vector<std::string> loads;
    std::string unit;  // of one of them, for the message
  };
  const CouplingView& view_;
  std::vector<Structure> structures_;
  std::vector<int> steps_;  // of each in a row, under load and without motion
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> structure_at_rest(const CouplingView& view) {
  return std::make_shared<StructureAtRest>(view);
}

}  // namespace couplet::coupler
