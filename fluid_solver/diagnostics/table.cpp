// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/parallel/collective.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {

#define FINDING(about, id, meaning)
#define LOOK(name, function) \
  template <int D>           \
  std::optional<diagnostics::Finding> function(const FluidView<D>&);
#define ESTIMATE(name, make) \
  template <int D>           \
  diagnostics::Made make(const FluidView<D>&);
#define DIAGNOSTIC ESTIMATE
#include "fluid_solver/diagnostics/table.def"
#undef LOOK
#undef DIAGNOSTIC
#undef ESTIMATE

/// Diagnostic without memory: findings of a function about the accepted state.
template <int D>
class Finds final : public diagnostics::Diagnostic {
 public:
  Finds(const FluidView<D>& view, std::optional<diagnostics::Finding> (*function)(const FluidView<D>&))
      : view_(view), function_(function) {}
  void look(diagnostics::Report& report) override {
    if (auto finding = function_(view_)) report.findings.push_back(std::move(*finding));
  }

 private:
  FluidView<D> view_;
  std::optional<diagnostics::Finding> (*function_)(const FluidView<D>&);
};

template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all) {
#define LOOK(name, function) all.add(name, std::make_shared<Finds<D>>(view, function<D>));
#define DIAGNOSTIC(name, make) all.add(name, make(view));
#define ESTIMATE(name, make) \
  if (all.with_errors()) all.add(name, make(view));
#include "fluid_solver/diagnostics/table.def"
#undef LOOK
#undef DIAGNOSTIC
#undef ESTIMATE
#undef FINDING
}

template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view) {
  std::vector<Index> faces;
  for (const mesh::Patch& patch : view.mesh.patches) {
    const GivenBy by = condition_of(view.parameters().boundaries.at(patch.name)).velocity;
    if (by != GivenBy::structure && by != GivenBy::motion) continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) faces.push_back(f);
  }
  return faces;
}

template <int D>
double largest_speed(const FluidView<D>& view) {
  double square = 0;
  for (const Vec<D>& u : view.fluid.state().u) square = std::max(square, u.squaredNorm());
  return std::sqrt(parallel::max(view.mesh.comm, square));
}

template <int D>
std::optional<double> pressure_range(const FluidView<D>& view) {
  const auto latest = view.fluid.pressure();
  if (!latest || view.step.number == 0) return {};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (Index c = 0; c < view.mesh.cells.n_owned(); ++c)
    low = std::min(low, latest->p[c]), high = std::max(high, latest->p[c]);
  return parallel::max(view.mesh.comm, high) - parallel::min(view.mesh.comm, low);
}

template void add_diagnostics(const FluidView<2>&, diagnostics::Diagnostics&);
template void add_diagnostics(const FluidView<3>&, diagnostics::Diagnostics&);
template std::vector<Index> moving_faces(const FluidView<2>&);
template std::vector<Index> moving_faces(const FluidView<3>&);
template double largest_speed(const FluidView<2>&);
template double largest_speed(const FluidView<3>&);
template std::optional<double> pressure_range(const FluidView<2>&);
template std::optional<double> pressure_range(const FluidView<3>&);

}  // namespace couplet::fluid
