// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "common/diagnostics/diagnostics.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

// Judges effects of turbulence and compressibility by numbers of a run.

/// Layers that the mesh does not resolve. `peclet`: largest cell Reynolds number; `yplus`: largest of walls, 0 without
/// walls; `reynolds`: by the largest speed and the hydraulic diameter.
diagnostics::EffectFinding unresolved_layers(int dimension, double peclet, double yplus, double reynolds);
/// Viscosity that a turbulence model adds, over the molecular one.
diagnostics::EffectFinding eddies(int dimension, double eddy_viscosity);
/// Walls under a turbulence model.
diagnostics::EffectFinding unresolved_walls(double yplus, double peclet);

/// `speed`: largest [m/s].
diagnostics::EffectFinding mach_number(double speed, const Sound& sound);
/// `density` [kg/m^3]; `range`: largest minus smallest pressure [Pa]; `speed`: largest [m/s].
diagnostics::EffectFinding change_of_density(bool is_compressible, double density, double range, double speed,
                                             const Sound& sound);
/// `stroke`: volume that moving walls sweep [m^3]; `pressure_volume`: pressure times the volume that it compresses [J];
/// fluctuations over the run.
diagnostics::EffectFinding compliance(double density, double stroke, double pressure_volume,
                                      const Sound& sound);
/// `rate`: of the motion of walls [1/s]; `size`: extent of the fluid [m].
diagnostics::EffectFinding wave_time(double rate, double size, const Sound& sound);

/// How walls move and how the pressure answers, over the time of a run: fluctuations about the means. Sums over the faces of
/// other ranks are the caller's.
class ComplianceWatch {
 public:
  /// Sums over all ranks.
  struct Totals {
    double swept = 0;            ///< net volume that the walls have swept [m^3]
    double pressure_volume = 0;  ///< pressure times the volume that it compresses [J]
  };
  /// After a step of length dt [s]. `swept`: volume swept since the start by each face of the moving walls [m^3].
  void add(double dt, const std::vector<double>& swept, const Totals& totals);

  /// Sums over this rank's faces: mean square of the volume that they sweep, of its rate, and the root mean square of
  /// the volume; [m^6], [m^6/s^2], [m^3].
  struct Walls {
    double square = 0, rate = 0, size = 0;
  };
  Walls walls() const;
  /// Root mean squares about the means.
  Totals totals() const;

  /// For checkpoints: the values per face, and what is the same on all ranks.
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

/// Tells whether the trapezoidal rule of a compressible fluid rings: waves of less than four steps a period, which it neither
/// resolves nor damps, make most of what the pressure changes. Of pressures p_0, p_1, p_2 of three steps these are
/// |p_0 - 2 p_1 + p_2| > |p_0 - p_2|, root mean squares over the volume. Returns the share
/// |p_0 - 2 p_1 + p_2| / (4 |p_0|) if it rings, else 0. Collective.
template <int D>
double ringing_share(const mesh::Mesh& mesh, const State<D>& state);

}  // namespace couplet::fluid
