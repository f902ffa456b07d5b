// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/types.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// Selection and compression of the volume fields that are written.
struct FieldChoice {
  int every = 1;        ///< at each n-th output, or 0 for never
  int compression = 0;  ///< level of deflate, 0 to 9
  struct Box {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< [m]
  };
  std::optional<Box> box;  ///< only cells whose mean of points at rest lies in it

  bool due(int number) const { return every > 0 && number % every == 0; }
};

struct OutputField {
  enum class Place { cells, points };
  std::string name;  ///< "velocity"
  std::string unit;  ///< "m/s"; shown in ParaView as "velocity [m/s]"
  Place place = Place::cells;
  int components = 1;              ///< 1, 2 or 3; 2 is padded to 3 in the file
  std::span<const double> values;  ///< per local cell or point (ghosts are ignored), entry by entry
};

/// Some cells or boundary faces of a body as a mesh of their own, without faces. The rank that owns a point
/// in the body owns it here.
struct MeshPart {
  mesh::Mesh mesh;             ///< ids are those of the body; for a surface cell_id is its boundary_id
  std::vector<Index> points;   ///< per local point: point of the body
  std::vector<Index> entries;  ///< per local cell: cell or face of the body
  std::vector<Vec3> places;    ///< positions of the points [m]
};

/// Makes a part of the flagged owned cells. `places` are the local points of the body [m]. Collective.
MeshPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags);
/// Flags the owned cells whose mean of points lies in a box. `places` are the local points [m].
std::vector<std::uint8_t> cells_within(const mesh::Mesh& mesh, std::span<const Vec3> places,
                                       const FieldChoice::Box& box);
/// Makes a mesh of the faces of one patch (edges in 2-D), in their order. Collective.
MeshPart make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch);

/// Restricts a field to some of its entries. Its values are copied to `values`.
OutputField picked(const OutputField& field, std::span<const Index> entries, std::vector<double>& values);

}  // namespace couplet::io
