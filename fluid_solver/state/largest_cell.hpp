// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

#include "common/parallel/collective.hpp"
#include "fluid_solver/state/placement.hpp"

namespace couplet::fluid {

/// The cell of all ranks in which something is largest.
struct LargestCell {
  double value = 0;
  GlobalIndex id = -1;        ///< as the mesh file numbers it; -1: no rank has a cell
  Vec3 place = Vec3::Zero();  ///< [m]
  int rank = 0;               ///< that owns it
  Index here = -1;            ///< of the owned cells of that rank
};

/// `value`: of an owned cell; what is not a number counts as larger than all. Collective; all but `here` is the same on all ranks.
template <int D, class Value>
LargestCell find_largest(const mesh::Mesh& mesh, const Placement<D>& at, const Value& value) {
  struct {
    double value;
    int rank;
  } worst{-std::numeric_limits<double>::infinity(), parallel::comm_rank(mesh.comm)};
  LargestCell found;
  const int own = worst.rank;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double given = value(c), size = std::isnan(given) ? std::numeric_limits<double>::infinity() : given;
    if (size <= worst.value) continue;
    worst.value = size;
    found.here = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh.comm);
  if (own != worst.rank) found.here = -1;
  double data[4] = {0, 0, 0, -1};
  if (found.here >= 0) {
    for (int d = 0; d < D; ++d) data[d] = at.centre[found.here][d];
    data[3] = static_cast<double>(mesh.cell_id[found.here]);
  }
  MPI_Bcast(data, 4, MPI_DOUBLE, worst.rank, mesh.comm);
  found.value = worst.value;
  found.rank = worst.rank;
  found.place = Vec3(data[0], data[1], data[2]);
  found.id = static_cast<GlobalIndex>(data[3]);
  return found;
}

/// Says where an equation that cannot be solved asks for most: "Its right-hand side is largest, 3e+200, in cell 7 at
/// (0.1, 0.5, 0) m."
inline std::string largest_entry(const LargestCell& of) {
  return fmt::format("Its right-hand side is {}, in cell {} at ({:.6g}, {:.6g}, {:.6g}) m.",
                     std::isfinite(of.value) ? fmt::format("largest, {:.3g}", of.value) : "not finite", of.id,
                     of.place.x(), of.place.y(), of.place.z());
}

}  // namespace couplet::fluid
