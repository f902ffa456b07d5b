// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io/probes/place_search.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Position in the reference configuration where values are monitored. It moves with the material.
///
/// The value is a weighted sum of point values that is exact for linear fields: a mesh point gives its own
/// value, a cell uses its shape functions. A position outside the mesh by less than `tolerance` is moved to
/// the nearest position on the boundary. Farther out is an Error that states the distance. Position and
/// weights do not depend on the number of ranks.
class Probe {
 public:
  /// `name` is for messages. `tolerance` [m] is 1e-6 of the mesh size by default. Collective over mesh.comm.
  Probe(const mesh::Mesh& mesh, std::span<const Vec3> places, const std::string& name, const Vec3& place,
        std::optional<double> tolerance = {});
  /// Finds one of many probes in a mesh. Returns nothing if the position lies outside. Collective.
  static std::optional<Probe> in(const PlaceSearch& search, const Vec3& place);

  /// Value on rank 0, empty elsewhere. `values` has `components` per local point, with ghosts up to date.
  /// Collective.
  std::vector<double> sample(std::span<const double> values, int components) const;

  /// Position of the probe in the reference configuration [m].
  const Vec3& place() const { return place_; }
  /// Local points and their weights on the one rank that holds the probe. Empty elsewhere.
  const std::vector<Index>& points() const { return points_; }
  const std::vector<double>& weights() const { return weights_; }

 private:
  explicit Probe(MPI_Comm comm) : comm_(comm) {}
  void take(const Vec3& place, int rank, const std::vector<Index>& points,
            const std::vector<double>& weights);
  MPI_Comm comm_;
  Vec3 place_ = Vec3::Zero();
  std::vector<Index> points_;
  std::vector<double> weights_;
};

}  // namespace couplet::io
