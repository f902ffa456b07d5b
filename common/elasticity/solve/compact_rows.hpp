// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "common/elasticity/elasticity.hpp"
#include "common/linalg/component_multigrid.hpp"

namespace couplet::elastic {

/// Two-point rows of the owned cells. Boundary faces and bonds to other ranks are only on the diagonal.
class CompactRows {
 public:
  using Lanes = linalg::ComponentMultigrid::Lanes;

  CompactRows(const mesh::Mesh& mesh, const ElasticOperator& rows, double boundary_factor,
              VolumeStrain left_out)
      : mesh_(mesh),
        geometry_(rows.geometry()),
        rows_(rows),
        boundary_factor_(boundary_factor),
        left_out_(left_out) {}

  linalg::ComponentMultigrid::Rows make(std::span<const double> inertia);

 private:
  bool owned(Index c) const { return c < mesh_.cells.n_owned(); }
  /// |S| / (d . n) [mu + (mu + lambda) n_c^2] per component.
  Lanes coefficient(Index f) const;
  /// Contribution of a boundary face to the diagonal of its cell.
  Lanes boundary_diagonal(Index f) const;
  /// Both sides of a bonded face in series.
  Lanes bond(Index f) const;
  template <class Take>
  void visit_couplings(const Take& take) const;

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  double boundary_factor_;
  VolumeStrain left_out_;
};

}  // namespace couplet::elastic
