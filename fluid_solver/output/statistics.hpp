// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/io/checkpoint.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Time means and second central moments of velocity and pressure per local cell, then per owned boundary face,
/// weighted with the steps (West's update, which loses no digits over long runs).
template <int D>
class RunningStatistics {
 public:
  static constexpr int n_shear = D * (D - 1) / 2;
  RunningStatistics(std::size_t cells, std::size_t faces);
  /// Statistics before the first state: NaN everywhere.
  static RunningStatistics nothing_yet(std::size_t cells, std::size_t faces);
  /// `state` and `pressure` (nullptr if there is none) held for dt [s].
  void add(const State<D>& state, const PressureLevel<D>* pressure, double dt);
  double duration() const { return duration_; }  ///< [s]

  std::size_t cells() const { return cells_; }
  /// Below, entries from cells() on are those of boundary faces; reynolds_shear() is of cells alone.
  const Vectors<D>& velocity_mean() const { return velocity_; }
  const std::vector<double>& pressure_mean() const { return pressure_; }
  Vectors<D> velocity_rms() const;
  std::vector<double> pressure_rms() const;
  /// <u'v'> in 2-D; <u'v'>, <u'w'>, <v'w'> in 3-D, per cell [m^2/s^2].
  std::vector<double> reynolds_shear() const;

  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  template <class Self, class Use>
  static void visit(Self& self, const Use& use);
  void add(std::size_t entry, const Vec<D>& velocity, double dt);
  void add_pressure(std::size_t entry, double pressure, double dt);

  std::size_t cells_;
  double duration_ = 0;
  Vectors<D> velocity_, normal_;                            // mean; sum dt u_i' u_i'
  std::vector<double> shear_, pressure_, pressure_square_;  // sum dt u_i' u_j'; mean; sum dt p'^2
};

}  // namespace couplet::fluid
