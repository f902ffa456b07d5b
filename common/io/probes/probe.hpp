// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/io/probes/place_search.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// One place in the reference configuration where values are watched. It moves with the material it lies in.
///
/// The value is a weighted sum of point values that is exact for linear fields: at a mesh point exactly that
/// point, in a cell its shape functions. A place outside the mesh by less than `tolerance` is taken to the
/// nearest place on the boundary; farther out is an Error that tells the distance. Same place and weights
/// whatever the number of ranks.
class Probe {
 public:
  /// Collective over mesh.comm. `name` is for messages; tolerance [m], by default 1e-6 of the mesh's size.
  Probe(const mesh::Mesh& mesh, std::span<const Vec3> places, const std::string& name, const Vec3& place,
        std::optional<double> tolerance = {});
  /// One of many in a mesh: nothing if the place lies outside it. Collective.
  static std::optional<Probe> in(const PlaceSearch& search, const Vec3& place);

  /// `values`: per local point (ghosts up to date), `components` each. The value on rank 0, empty elsewhere.
  /// Collective.
  std::vector<double> sample(std::span<const double> values, int components) const;

  /// Where the probe really is (reference configuration) [m].
  const Vec3& place() const { return place_; }
  /// Local points and their weights on the one rank that holds the probe; empty elsewhere.
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
