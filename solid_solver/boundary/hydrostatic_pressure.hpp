// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/load_parameters.hpp"

namespace couplet::solid {

/// rho |g| max(0, level - height) of a liquid at rest, averaged over a face of the reference configuration: exact where the
/// free surface cuts the face, too.
class HydrostaticPressure {
 public:
  /// Throws Error, naming `where`.
  HydrostaticPressure(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const TotalLoad& load,
                      const std::string& where);

  /// The free surface at time t [m].
  double level(double t) const { return level_(Vec3::Zero(), t); }
  /// Mean over a face under this free surface [Pa].
  double mean(Index face, double level) const;

 private:
  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  fv::Expression level_;
  Vec3 up_ = Vec3::Zero();
  double weight_ = 0;  // rho |g| [N/m^3]
};

/// Mean of max(0, d) for d linear between the ends of an edge.
double mean_positive(double d0, double d1);
/// The same on a triangle.
double mean_positive(double d0, double d1, double d2);

}  // namespace couplet::solid
