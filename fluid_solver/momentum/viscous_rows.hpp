// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// A symmetric matrix by the rows of the owned cells, all of one width: what CG does with it takes one pass over the rows and two
/// over the vectors. A loop over the faces, which writes each cell once per face, takes twice the instructions.
struct ViscousRows {
  Index width = 0;  ///< entries per row beside the diagonal: the most neighbours of a cell
  std::vector<Index> column,
      face;  ///< local cells, and the faces between; where there is none: the row's own cell, and -1
  std::vector<double> value;     ///< 0 where there is none
  std::vector<double> diagonal;  ///< per owned cell

  explicit ViscousRows(const mesh::Mesh& mesh);
  Index size() const { return static_cast<Index>(diagonal.size()); }
};

/// y = A x; returns x.y over the owned cells. `x`: per local cell, with ghosts current.
double multiply(const ViscousRows& a, const Vectors<2>& x, Vectors<2>& y);
double multiply(const ViscousRows& a, const Vectors<3>& x, Vectors<3>& y);

/// A step of CG: u += alpha s, r -= alpha q; returns r.r.
double go_along(double alpha, std::span<const double> s, std::span<const double> q, std::span<double> u,
                std::span<double> r);

/// The next search direction: s = r + gamma s.
void turn_search(double gamma, std::span<const double> r, std::span<double> s);

}  // namespace couplet::fluid
