// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/parameters.hpp"
#include "coupler/sparse_map.hpp"

namespace couplet {

/// Points of one side of the interface; `what` names them in messages: "vertices of 'fluid'".
struct PointSet {
  std::string what;
  std::vector<Vec3> points;
  std::vector<double> sizes{};         ///< areas of faces [m^2], for shares; empty: all alike
  const Interface* surface = nullptr;  ///< that these are the vertices or the face centres of; for projection
};

/// How values go from one set of points to another, as a sparse matrix built once on the reference
/// configuration. By type of `coupling.mapping`:
///   matched     twins, weight 1
///   nearest     as below
///   projection  at vertices: the value at the nearest point of the other surface; at faces: local
///   interpolants
///               through few neighbours
///   rbf         local interpolants by compact radial functions through more neighbours
/// Both of the latter carry linear fields exactly; their forces are cut over each face and shared out with
/// the transposed weights, so that force and moment are kept.
class Mapping {
 public:
  enum class Kind {
    consistent,    ///< nearest: every target takes the value of its nearest source: displacements, velocities
    conservative,  ///< nearest: every source is shared out, by size, among the targets nearest to it (or goes
                   ///< to its own nearest target if it is nearest to none): forces; the sum is kept
  };
  /// matched: throws Error naming points without a twin, with place and distance; nearest: any distance is
  /// good.
  Mapping(Kind kind, const PointSet& from, const PointSet& to, const MappingParameters& parameters);

  std::vector<double> apply(const std::vector<double>& values, int components) const {
    return map_.apply(values, components);
  }

  std::size_t n_from() const { return n_from_; }
  std::size_t n_to() const { return n_to_; }
  double max_distance() const { return max_distance_; }
  double mean_distance() const { return mean_distance_; }
  /// "168 vertices of 'solid' to 168 vertices of 'fluid', distance at most 0 m, mean 0 m"
  std::string summary() const { return summary_; }

 private:
  std::size_t n_from_, n_to_;
  SparseMap map_;
  double max_distance_ = 0, mean_distance_ = 0;
  std::string summary_;
};

}  // namespace couplet
