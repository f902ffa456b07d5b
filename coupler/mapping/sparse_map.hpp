// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/coupling/participant.hpp"
#include "coupler/exchange/transfer.hpp"

namespace couplet::coupler {

/// Linear map between two sets of places: target i is the sum of weight[k] times source[k] over offset[i] <=
/// k < offset[i + 1]. It applies to each component of a vector.
struct SparseMap {
  std::size_t n_from = 0;
  std::vector<std::size_t> offset{0};
  std::vector<Index> source;
  std::vector<double> weight;

  std::size_t n_to() const { return offset.size() - 1; }
  void push_row(std::span<const Index> sources, std::span<const double> weights);
  std::vector<double> apply(std::span<const double> values, int components) const;
  /// Map from targets to sources with the same weights; keeps sums if all rows sum to 1.
  SparseMap transposed() const;
};

/// Weights of the sources for the value at x. Interpolates by Wendland's compact C2 function phi(r) = (1 -
/// r/R)^4 (4 r/R + 1) with a linear polynomial [Wendland 1995; de Boer et al. 2007]. The weights sum to 1 and
/// are exact for linear fields. The polynomial covers only directions in which the sources spread, so that
/// collinear or coplanar points are no problem. In other directions the value is constant, as it is at x far
/// from the sources in a direction of little spread. One source gives its value.
std::vector<double> local_weights(const std::vector<Vec3>& points, std::span<const Index> sources,
                                  const Vec3& x);

/// Each target takes the value at its nearest point of the surface: linear along edges (2-D) or over the
/// triangles of faces (3-D; faces with more corners are split about their center). Beyond the surface's end
/// the value at the end is used.
SparseMap nearest_projection(const coupling::Interface& surface, const std::vector<Vec3>& targets);

/// Throws Error with advice if the corners of the faces are not `known`.
void require_corners(bool known);

/// Search range of nearest_projection: the nearest face touches one of so many nearest vertices, or is large
/// and has its center among so many nearest ones.
inline constexpr std::size_t projection_vertices = 3, projection_faces = 4;
/// Number of faces with nearest centers to choose from if no face covers a place.
inline constexpr std::size_t nearest_faces = 9;

/// Distance [m] of a place from a face with known corners.
double distance_to_face(const coupling::Interface& surface, Index face, const Vec3& place);

/// Rows of a map by the targets' positions, columns by the sources'.
void add_entries(const SparseMap& map, const std::vector<GlobalIndex>& targets,
                 const std::vector<GlobalIndex>& sources, std::vector<Transfer::Entry>& entries);

/// Each target takes the local interpolant through its k nearest sources.
SparseMap local_interpolation(const std::vector<Vec3>& sources, const std::vector<Vec3>& targets,
                              std::size_t k);

/// Throws Error with the participant if its corners are listed incorrectly. `vertices`: number on all ranks.
void check_corners(const coupling::Interface& surface, const std::string& name, GlobalIndex vertices);

}  // namespace couplet::coupler
