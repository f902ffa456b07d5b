// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "common/mesh/mesh.hpp"
#include "solid_solver/parameters/load_parameters.hpp"

namespace couplet::solid {

/// A pin in a hole, or a bush around a shaft: the pressure -q . m pushes on the half of a cylinder where it is positive, m
/// being the normals across the axis, out of the solid. Of a force F, sum A_i m_i m_i^T q = F over that half: a pressure by the
/// cosine of the angle to the force on a cylinder, with F as its total to round-off on any mesh. A dead load: it keeps
/// its directions at large strain.
class BearingLoad {
 public:
  /// `faces`: this rank's. Throws Error, naming `where`, if they are no cylinder. Collective.
  BearingLoad(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
              const TotalLoad& load, std::string where);

  /// Adds the forces at time t [N], `dim` values a boundary face of owned cells. Throws Error for a force along the axis and
  /// for one that no face can take. Collective.
  void add_forces(double t, std::span<double> forces) const;

 private:
  void find_axis();
  Vec3 force_at(double t) const;
  struct Push {
    Vec3 half;  ///< the loaded faces: half . m < 0
    Vec3 q;     ///< [Pa]
  };
  Push find_push(const Vec3& force) const;

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  std::string where_;
  std::vector<Index> faces_;
  std::vector<Vec3> across_;  // m, one a face
  std::vector<fv::Expression> force_;
  Vec3 axis_ = Vec3::UnitZ();
  double area_ = 0;
};

}  // namespace couplet::solid
