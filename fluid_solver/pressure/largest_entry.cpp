// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/pressure/largest_entry.hpp"

#include <cmath>
#include <limits>

#include "common/base/error.hpp"

namespace couplet::fluid {

template <int D>
std::string largest_entry(const mesh::Mesh& mesh, const Placement<D>& at,
                          const std::function<double(Index)>& size) {
  struct {
    double value;
    int rank;
  } worst{-1, 0};
  MPI_Comm_rank(mesh.comm, &worst.rank);
  const int here = worst.rank;
  Index where = -1;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    const double entry = std::abs(size(c));
    const double value = std::isnan(entry) ? std::numeric_limits<double>::infinity() : entry;
    if (value <= worst.value) continue;
    worst.value = value;
    where = c;
  }
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, mesh.comm);
  double data[4] = {0, 0, 0, -1};
  if (here == worst.rank && where >= 0) {
    for (int d = 0; d < D; ++d) data[d] = at.centre[where][d];
    data[3] = static_cast<double>(mesh.cell_id[where]);
  }
  MPI_Bcast(data, 4, MPI_DOUBLE, worst.rank, mesh.comm);
  return fmt::format("Its right-hand side is {}, in cell {} at ({:.6g}, {:.6g}, {:.6g}) m.",
                     std::isfinite(worst.value) ? fmt::format("largest, {:.3g}", worst.value) : "not finite",
                     static_cast<GlobalIndex>(data[3]), data[0], data[1], data[2]);
}

template std::string largest_entry(const mesh::Mesh&, const Placement<2>&,
                                   const std::function<double(Index)>&);
template std::string largest_entry(const mesh::Mesh&, const Placement<3>&,
                                   const std::function<double(Index)>&);

}  // namespace couplet::fluid
