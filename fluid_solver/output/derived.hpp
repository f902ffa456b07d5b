// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io/checkpoint.hpp"
#include "fluid_solver/state/state.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// Time means and second central moments of velocity and pressure, per local cell and then per owned boundary
/// face, weighted with the steps. West's update avoids round-off over long runs.
template <int D>
class RunningStatistics {
 public:
  static constexpr int n_shear = D * (D - 1) / 2;
  RunningStatistics(std::size_t cells, std::size_t faces);
  /// Statistics before the first state, NaN everywhere.
  static RunningStatistics nothing_yet(std::size_t cells, std::size_t faces);
  /// Adds `state` and `pressure` (nullptr if there is none) with the weight dt [s].
  void add(const State<D>& state, const PressureLevel<D>* pressure, double dt);
  double duration() const { return duration_; }  ///< [s]

  std::size_t cells() const { return cells_; }
  /// Entries from cells() on belong to boundary faces; reynolds_shear() covers only cells.
  const Vectors<D>& velocity_mean() const { return velocity_; }
  const std::vector<double>& pressure_mean() const { return pressure_; }
  Vectors<D> velocity_rms() const;
  std::vector<double> pressure_rms() const;
  /// <u'v'> in 2-D; <u'v'>, <u'w'>, <v'w'> in 3-D, per cell [m^2/s^2].
  std::vector<double> reynolds_shear() const;

  void visit(io::Archive archive);

 private:
  void add(std::size_t entry, const Vec<D>& velocity, double dt);
  void add_pressure(std::size_t entry, double pressure, double dt);

  std::size_t cells_;
  double duration_ = 0;
  Vectors<D> velocity_, normal_;                            // mean; sum dt u_i' u_i'
  std::vector<double> shear_, pressure_, pressure_square_;  // sum dt u_i' u_j'; mean; sum dt p'^2
};

/// Wall shear and the distance of the first cell in wall units, y+ = y (tau/rho)^(1/2)/nu. y is the normal
/// distance of the cell center from the wall, tau the mean over the last step.
struct WallSummary {
  double largest_shear = 0, mean_shear = 0;  ///< [Pa]; mean over the area
  double largest_yplus = 0, mean_yplus = 0;
};
/// Collective.
template <int D>
WallSummary summarise_wall(const Fluid<D>& fluid, const mesh::Patch& patch);
/// tau [Pa] and y+ at each boundary face; empty before the first step.
template <int D>
std::vector<std::array<double, 2>> wall_units(const Fluid<D>& fluid);

/// Coefficients of drag, lift and moment from the forces on some walls, means over the last step: sum F.d/(q
/// A), sum F.l/(q A), sum ((x - c) x F).a/(q A L).
struct ForceCoefficients {
  double drag = 0, lift = 0, moment = 0;
};
/// Collective.
template <int D>
ForceCoefficients force_coefficients(const Fluid<D>& fluid, const CoefficientParameters& parameters);

/// Kinetic energy [J] and its losses [W] in the scheme. The losses are the sum over faces of mu g |du|^2
/// (orthogonal part), the eddy force times du, and the sum of V grad p.u at t^{n+1/2}. The last one arises
/// because cell velocities are not exactly divergence-free, which suppresses checkerboards; in an open domain
/// it includes the work at inlets and outlets. Collective.
struct EnergyBudget {
  double kinetic = 0, viscous = 0, eddies = 0, pressure = 0;
};
template <int D>
EnergyBudget energy_budget(const Fluid<D>& fluid);

/// Field of the fluid for files, probes and samples.
struct FlowQuantity {
  std::string name, unit;
  int components = 1;
  std::span<const double> cells;     ///< per local cell
  std::span<const double> boundary;  ///< per owned boundary face; empty if it is known only in the cells
};

/// Fields of the accepted state that the case asks for. They become invalid when it advances.
template <int D>
class FlowQuantities {
 public:
  /// Adds velocity and pressure; the pressure is zero before the first step.
  explicit FlowQuantities(const Fluid<D>& fluid);
  FlowQuantities(const FlowQuantities&) = delete;
  /// Adds means and root mean squares.
  void add(const RunningStatistics<D>& statistics);
  /// Adds the fields known only in cells. `statistics`: nullptr if there are none. Collective.
  void add_in_cells(const RunningStatistics<D>* statistics);

  const std::vector<FlowQuantity>& all() const { return all_; }
  /// Sum of the components.
  int width() const;

 private:
  std::span<const double> keep(std::vector<double> values);
  void add(const char* name, const char* unit, int components, std::span<const double> values,
           std::size_t cells);

  const Fluid<D>& fluid_;
  std::vector<FlowQuantity> all_;
  std::shared_ptr<const PressureLevel<D>> pressure_;
  std::deque<std::vector<double>> kept_;  // values computed here
};

}  // namespace couplet::fluid
