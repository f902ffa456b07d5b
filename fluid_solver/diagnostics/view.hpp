// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

// Judges effects of turbulence and compressibility by results of a run.

/// Layers that the mesh does not resolve. `shear`: largest Reynolds number of the shear within a cell. `yplus`: largest y+ at
/// the walls, 0 without walls. `reynolds`: of the largest speed and the width of the flow, NaN without walls.
diagnostics::EffectFinding unresolved_layers(int dimension, double shear, double yplus, double reynolds);
/// Eddy viscosity of a turbulence model relative to the molecular one.
diagnostics::EffectFinding eddies(int dimension, double eddy_viscosity);
/// Viscosity law. `variation`: standard deviation of the viscosity over its mean, `mean` [Pa s], both weighted by the power that
/// it takes.
diagnostics::EffectFinding varying_viscosity(double variation, double mean);
/// Resolution of walls under a turbulence model.
diagnostics::EffectFinding unresolved_walls(double yplus);

/// `speed`: largest [m/s].
diagnostics::EffectFinding mach_number(double speed, const Sound& sound);
/// `density` [kg/m^3]; `range`: largest minus smallest pressure [Pa]; `speed`: largest [m/s].
diagnostics::EffectFinding change_of_density(bool is_compressible, double density, double range, double speed,
                                             const Sound& sound);
/// `stroke`: volume swept by moving walls [m^3]. `pressure_volume`: pressure times the volume it compresses
/// [J]. Both are fluctuations over the run.
diagnostics::EffectFinding compliance(double density, double stroke, double pressure_volume,
                                      const Sound& sound);
/// `rate`: rate of the wall motion [1/s]. `size`: extent of the fluid [m].
diagnostics::EffectFinding wave_time(double rate, double size, const Sound& sound);

/// Records the wall motion and the pressure response over a run, as fluctuations about the means. Callers sum
/// over the faces of all ranks.
class ComplianceMeans {
 public:
  /// Sums over all ranks.
  struct Totals {
    double swept = 0;            ///< net volume that the walls have swept [m^3]
    double pressure_volume = 0;  ///< pressure times the volume that it compresses [J]
  };
  /// Adds a step of length dt [s]. `swept`: volume swept so far by each face of the moving walls [m^3].
  void add(double dt, const std::vector<double>& swept, const Totals& totals);

  /// Sums over this rank's faces: mean square of the swept volume [m^6] and of its rate [m^6/s^2], and root
  /// mean square of the volume [m^3].
  struct Walls {
    double square = 0, rate = 0, size = 0;
  };
  Walls walls() const;
  double time() const { return time_; }  ///< [s]
  /// Root mean squares about the means.
  Totals totals() const;

  /// Data for checkpoints: values per face, and values that are equal on all ranks.
  std::array<std::vector<double>*, 4> per_face() { return {&last_, &sum_, &square_, &rate_}; }
  template <class Numbers>
  void visit(Numbers& numbers) {
    numbers(time_, mean_.swept, mean_.pressure_volume, mean_square_.swept, mean_square_.pressure_volume,
            steps_);
  }

 private:
  std::vector<double> last_, sum_, square_, rate_;  // per face
  double time_ = 0;
  Totals mean_, mean_square_;  // times time_
  int steps_ = 0;
};

constexpr double ringing_limit = 0.05;

/// Detects ringing of the trapezoidal rule of a compressible fluid. Waves of less than four steps per period,
/// neither resolved nor damped, then dominate the change of pressure: |p_0 - 2 p_1 + p_2| > |p_0 - p_2| for
/// three successive pressures, as root mean squares over the volume. Returns |p_0 - 2 p_1 + p_2|/(4 |p_0|) if
/// it rings, else 0. Collective.
template <int D>
double ringing_share(const mesh::Mesh& mesh, const State<D>& state);

/// State of a fluid run after the last accepted step, as diagnostics see it.
template <int D>
struct FluidView {
  const mesh::Mesh& mesh;
  const Fluid<D>& fluid;
  SubStepSize<D>& sizes;       ///< limits of the step; caches its results
  const coupling::Step& step;  ///< the accepted one
  bool has_interface;          ///< a structure moves some walls
  bool has_mover;              ///< a mesh mover moves the mesh
  bool is_prescribed;          ///< the case moves the mesh
  /// Largest displacement of an interface on a mesh at rest, relative to the cell height there.
  const double& wall_displacement;

  const FluidParameters& parameters() const { return fluid.parameters(); }
  Properties properties() const { return parameters().properties(); }
  int rank() const { return parallel::comm_rank(mesh.comm); }
  bool stands_still() const {
    return has_interface && !has_mover && step.scheme != coupling::Scheme::standalone;
  }
};

/// Faces of walls that move in their normal direction.
template <int D>
std::vector<Index> moving_faces(const FluidView<D>& view);

// Quantities used by several diagnostics. Collective.
template <int D>
double largest_speed(const FluidView<D>& view);  ///< [m/s]
/// Largest minus smallest pressure [Pa]. Empty in the first step, whose pressure is an impulse.
template <int D>
std::optional<double> pressure_range(const FluidView<D>& view);

// Each finds something in the accepted state, or nothing.
template <int D>
std::optional<diagnostics::Finding> turbulence_model(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> eddies_in_two_dimensions(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> variation_of_viscosity(const FluidView<D>& view);
/// Temperatures below absolute zero.
template <int D>
std::optional<diagnostics::Finding> impossible_temperature(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> resolved_walls(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> kinetic_energy(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> compressibility(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> changes_of_density(const FluidView<D>& view);
template <int D>
std::optional<diagnostics::Finding> mesh_at_rest(const FluidView<D>& view);
// Each makes a diagnostic, or nullptr if it does not apply to the flow.
template <int D>
diagnostics::Made waves_of_pressure(const FluidView<D>& view);
template <int D>
diagnostics::Made ringing_pressure(const FluidView<D>& view);
template <int D>
diagnostics::Made given_step(const FluidView<D>& view);
template <int D>
diagnostics::Made flow_through_openings(const FluidView<D>& view);
template <int D>
diagnostics::Made place_on_the_map(const FluidView<D>& view);
template <int D>
diagnostics::Made flow_error(const FluidView<D>& view);

/// Adds all diagnostics of a fluid.
template <int D>
void add_diagnostics(const FluidView<D>& view, diagnostics::Diagnostics& all);

}  // namespace couplet::fluid
