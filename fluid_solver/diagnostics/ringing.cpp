// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/diagnostics/effects.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/diagnostics/view.hpp"

namespace couplet::fluid {
namespace {

constexpr int rung_steps = 10;  // in a row, before it is told

template <int D>
class RingingPressure final : public diagnostics::Diagnostic {
 public:
  explicit RingingPressure(const FluidView<D>& view) : view_(view) {}
  void observe(diagnostics::Report& report) override {
    const double share = ringing_share(view_.mesh, view_.fluid.state());
    steps_ = share > ringing_limit ? steps_ + 1 : 0;
    if (steps_ < rung_steps) return;
    report.findings.push_back(
        {.id = "ringing-pressure",
         .number = share,
         .limit = ringing_limit,
         .sentence = fmt::format("the pressure rings: {:.2g} of it (limit {:g}) are waves of less than "
                                 "four steps per period, which the trapezoidal rule does not damp",
                                 share, ringing_limit),
         .advice = "use 'scheme: three-level' in 'compressibility', or a shorter step"});
  }
  void visit(io::Archive& archive) override { archive.common("steps", steps_); }

 private:
  FluidView<D> view_;
  int steps_ = 0;  // in a row
};

}  // namespace

template <int D>
double ringing_share(const mesh::Mesh& mesh, const State<D>& s) {
  if (!s.pressure[2]) return 0;
  const std::vector<double>&p0 = s.pressure[0]->p, &p1 = s.pressure[1]->p, &p2 = s.pressure[2]->p;
  double sums[3] = {};
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double v = s.placement->volume[c], turn = p0[c] - 2 * p1[c] + p2[c], change = p0[c] - p2[c];
    sums[0] += v * turn * turn, sums[1] += v * change * change, sums[2] += v * p0[c] * p0[c];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return sums[0] > sums[1] && sums[2] > 0 ? std::sqrt(sums[0] / sums[2]) / 4 : 0;
}

template <int D>
diagnostics::Made ringing_pressure(const FluidView<D>& view) {
  const auto& known = view.parameters().compressibility;
  if (!known || known->scheme != WaveScheme::trapezoidal) return nullptr;
  return std::make_shared<RingingPressure<D>>(view);
}

template double ringing_share(const mesh::Mesh&, const State<2>&);
template double ringing_share(const mesh::Mesh&, const State<3>&);
template diagnostics::Made ringing_pressure(const FluidView<2>&);
template diagnostics::Made ringing_pressure(const FluidView<3>&);

}  // namespace couplet::fluid
