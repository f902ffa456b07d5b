// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

// Minimum share of the volume through an opening in one direction (more than an oscillation), and of the
// volume through the largest opening (more than a trickle).
constexpr double always = 0.9, much = 0.1;

/// Checks flow directions over the run. Permanent outflow at an inlet or inflow at an outlet suggests a wrong
/// sign or name.
template <int D>
class FlowThroughOpenings final : public diagnostics::Diagnostic {
 public:
  explicit FlowThroughOpenings(const FluidView<D>& view) : view_(view) {
    // A moving wall may draw fluid in through an outlet.
    const bool at_rest = !view.has_mover && !view.is_prescribed && !view.has_interface;
    for (const mesh::Patch& patch : view.mesh.patches) {
      const BoundaryParameters& b = view.parameters().boundaries.at(patch.name);
      const bool inlet = condition_of(b).passage == Passage::in;
      // A pressure given on purpose may drive the flow.
      const bool outlet = at_rest && gives_pressure(b) && b.pressure.text == "0";
      if (inlet || outlet) openings_.push_back({&patch, inlet});
    }
    sums_.resize(2 * openings_.size());
  }
  void observe(diagnostics::Report&) override {
    const std::vector<double>& phi = view_.fluid.state().phi;
    for (std::size_t i = 0; i < openings_.size(); ++i) {
      const mesh::Patch& patch = *openings_[i].patch;
      for (Index f = patch.first; f < patch.first + patch.count; ++f) {
        sums_[2 * i] += phi[f] * view_.step.dt;
        sums_[2 * i + 1] += std::abs(phi[f]) * view_.step.dt;
      }
    }
  }
  void conclude(diagnostics::Report& report) override {
    std::vector<double> sums = sums_;
    for (double& value : sums) value = parallel::sum(view_.mesh.comm, value);
    double largest = 0;
    for (std::size_t i = 1; i < sums.size(); i += 2) largest = std::max(largest, sums[i]);
    for (std::size_t i = 0; i < openings_.size(); ++i) {
      const auto& [patch, inlet] = openings_[i];
      const double wrong = inlet ? sums[2 * i] : -sums[2 * i], gross = sums[2 * i + 1];
      if (!(wrong > always * gross) || !(gross > much * largest)) continue;
      report.findings.push_back(
          {.id = "flow-through-openings",
           .sentence =
               inlet
                   ? fmt::format("inlet '{}': outflow {:.3g} m^3 (expected: none): implausible; its velocity "
                                 "must point into the domain: check the signs",
                                 patch->name, wrong)
                   : fmt::format(
                         "outlet '{}': inflow {:.3g} m^3 (expected: none): questionable; the velocity "
                         "of inflow through an outlet is undetermined: make it an inlet, or prescribe "
                         "the driving pressure",
                         patch->name, wrong),
           .subject = patch->name});
    }
  }
  void visit(io::Archive& archive) override { archive.sums("volumes", sums_); }

 private:
  struct Opening {
    const mesh::Patch* patch;
    bool inlet;
  };
  FluidView<D> view_;
  std::vector<Opening> openings_;
  std::vector<double> sums_;  // net and gross of each, outward, of this rank [m^3]
};

}  // namespace

template <int D>
diagnostics::Made flow_through_openings(const FluidView<D>& view) {
  return std::make_shared<FlowThroughOpenings<D>>(view);
}

template diagnostics::Made flow_through_openings(const FluidView<2>&);
template diagnostics::Made flow_through_openings(const FluidView<3>&);

}  // namespace couplet::fluid
