// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solid_solver/thermal/heat.hpp"

namespace couplet::solid {

/// The matrix of a steady field, conductivities that do not vary, with other data: what the dual problem needs of Heat.
class HeatAnswer final {
 public:
  /// By reference.
  explicit HeatAnswer(const Heat& heat) : heat_(heat) {}

  bool properties_vary() const { return heat_.properties_vary_; }
  const HeatBoundaries& boundaries() const { return heat_.boundaries_; }
  /// Of the last step, per local face [W/(m K)].
  std::span<const double> conductivity() const { return heat_.conductivity_; }
  /// h |S| of the flux faces [W/K], entry by entry of conduction().flux_faces(); empty: no convection.
  std::vector<double> transfer() const;
  /// What the value at a cell's centre leaves out of the source in the cell [W], accepted time; empty: no source.
  std::vector<double> source_missed() const;
  /// The field of other `sources` [W], one a row, and known values. Throws SolveFailure. Collective.
  HeatState field(std::vector<double> sources, std::vector<double> known) const;

 private:
  const Heat& heat_;
};

}  // namespace couplet::solid
