// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::fluid {

template <int D>
using Vectors = std::vector<Vec<D>>;

/// Flat view of an array of vectors, for halo updates, output and checkpoints.
template <int D>
std::span<double> flat(Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}
template <int D>
std::span<const double> flat(const Vectors<D>& values) {
  return {values.empty() ? nullptr : values.front().data(), values.size() * D};
}

/// Geometry of one placement of the points for face loops, per flux face of the mesh (interior faces, then
/// the boundary of owned cells) unless stated otherwise.
template <int D>
struct Placement {
  std::vector<double> volume;  ///< V [m^3], per local cell
  Vectors<D> area;             ///< S [m^2], out of the owner
  /// g = |S|^2/(S.d) [m], over-relaxed; d from the owner to the neighbor (or face) center.
  std::vector<double> conductance;
  Vectors<D> oblique;          ///< k = S - g d [m^2], tangential; empty on orthogonal meshes
  std::vector<double> weight;  ///< of the owner in the linear interpolation to the face, per interior face
  Vectors<D> centre;           ///< per local cell [m]
  std::vector<Vec3> boundary_centre;  ///< per owned boundary face [m]
  double obliqueness = 0;             ///< largest |k|/|S| on this rank
  /// Vector from the interpolation point to the face center, per interior face [m]; empty if not skewed.
  Vectors<D> skew;
  /// Per local cell, with `skew`: matrix B that makes the Gauss gradient G of values at the interpolation
  /// points exact for linear fields: G B for vectors (du_i/dx_j), B^T G for scalars.
  std::vector<Tensor<D>> gradient_cure;
  bool skewed() const { return !skew.empty(); }
  /// Vector from the midpoint between the cells to the face center, skewed meshes only [m].
  Vec<D> offset(Index f) const {
    return skew[f] + (0.5 - weight[f]) / conductance[f] * (area[f] - oblique_of(f));
  }
  /// Shared by placements that are translations of each other; nullptr if unknown.
  std::shared_ptr<const char> shape{};
  /// k of a face [m^2], zero on orthogonal meshes.
  Vec<D> oblique_of(Index face) const { return oblique.empty() ? Vec<D>(Vec<D>::Zero()) : oblique[face]; }
};
/// Correction of a value interpolated linearly between the cells at an interior face of a skewed mesh.
template <int D>
double skew_part(const mesh::Mesh& mesh, const Placement<D>& at, const Vectors<D>& gradient, Index f) {
  const double weight = at.weight[f];
  return (weight * gradient[mesh.owner[f]] + (1 - weight) * gradient[mesh.neighbour[f]]).dot(at.skew[f]);
}
/// Limit of |k|/|S| for a mesh to count as orthogonal.
constexpr double orthogonal = 1e-9;

/// Collective.
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, const mesh::Geometry& geometry);
template <int D>
std::shared_ptr<const Placement<D>> make_placement(const mesh::Mesh& mesh, std::span<const Vec3> points);
/// Translates a placement: only the centers differ. `from` must have a shape.
template <int D>
std::shared_ptr<const Placement<D>> translated(const Placement<D>& from, const Vec3& by);

/// Placement in which values at marked interior faces are means of the cell values, wherever the face lies.
template <int D>
std::shared_ptr<const Placement<D>> in_the_middle(const mesh::Mesh& mesh, const Placement<D>& from,
                                                  std::span<const char> faces);

/// Largest side of the bounding box of points [m]. Collective.
double largest_extent(const mesh::Mesh& mesh, std::span<const Vec3> points);

/// Cell with the largest value over all ranks.
struct LargestCell {
  double value = 0;
  GlobalIndex id = -1;        ///< number in the mesh file; -1 if no rank has a cell
  Vec3 place = Vec3::Zero();  ///< [m]
  int rank = 0;               ///< owner
  Index here = -1;            ///< local number on that rank; -1 elsewhere
};

/// `value`: function of an owned cell; NaN counts as largest. Collective; only `here` differs between ranks.
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

/// Describes the largest entry of a failed equation: "Its right-hand side is largest, 3e+200, in cell 7 at
/// (0.1, 0.5, 0) m."
inline std::string largest_entry(const LargestCell& of) {
  return fmt::format("Its right-hand side is {}, in cell {} at ({:.6g}, {:.6g}, {:.6g}) m.",
                     std::isfinite(of.value) ? fmt::format("largest, {:.3g}", of.value) : "not finite", of.id,
                     of.place.x(), of.place.y(), of.place.z());
}

// Sums over the interior faces of each cell, compiled for several instruction sets.

/// sum -= factor times the outflow of phi; returns the sum of squares of phi.
double subtract_outflow(const mesh::Mesh& mesh, double factor, std::span<const double> phi,
                        std::span<double> sum);
/// sum += outflow of phi through all faces, including the boundary.
void add_outflow(const mesh::Mesh& mesh, std::span<const double> phi, std::span<double> sum);
/// phi -= factor g (p_N - p_P).
struct FluxCorrection {
  double factor;
  const double* conductance;  ///< g
  double* phi;
};
/// sum += p_f S, p_f linear between the cells. `correction`: computed in the same pass; nullptr for none.
template <int D>
void add_pressure(const mesh::Mesh& mesh, const Placement<D>& at, std::span<const double> p,
                  const FluxCorrection* correction, Vectors<D>& sum);

}  // namespace couplet::fluid
