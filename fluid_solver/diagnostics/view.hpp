// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// View of a run that the fluid shows, as it is after the last accepted step.
template <int D>
struct FluidView {
  const mesh::Mesh& mesh;
  const Fluid<D>& fluid;
  SubStepSize<D>& sizes;       ///< limits of the step; keeps what it has looked up
  const coupling::Step& step;  ///< the accepted one
  bool has_interface;          ///< walls that a structure moves
  bool has_mover;              ///< a mesh mover moves the mesh
  bool is_prescribed;          ///< the case moves the mesh
  /// For an interface on a mesh at rest: largest displacement over the height of the cell there.
  const double& wall_displacement;
  const int& renewals;         ///< of the prediction, in the last step
  const double& unseen_share;  ///< error of the friction at the end of the last step, over the load

  const FluidParameters& parameters() const { return fluid.parameters(); }
  int rank() const { return parallel::comm_rank(mesh.comm); }
  bool stands_still() const {
    return has_interface && !has_mover && step.scheme != coupling::Scheme::standalone;
  }
};

/// Faces of walls that move across themselves.
template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view);

// Quantities that several diagnostics look at. Collective.
template <int D>
double largest_speed(const FluidView<D>& view);  ///< [m/s]
/// Largest minus smallest pressure [Pa]; none in the first step, whose pressure is the impulse that starts the motion.
template <int D>
std::optional<double> pressure_range(const FluidView<D>& view);

/// Adds all diagnostics of a fluid.
template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all);

/// A diagnostic without memory: what a function finds in the accepted state.
template <int D>
class Finds final : public diagnostics::Diagnostic {
 public:
  using Function = std::optional<diagnostics::Finding>(const FluidView<D>&);
  Finds(const FluidView<D>& view, Function* function) : view_(view), function_(function) {}
  void look(diagnostics::Report& report) override {
    if (auto finding = function_(view_)) report.findings.push_back(std::move(*finding));
  }

 private:
  FluidView<D> view_;
  Function* function_;
};

}  // namespace couplet::fluid
