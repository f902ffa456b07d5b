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

/// What of the fields in the volume is written, and how.
struct FieldChoice {
  int every = 1;        ///< at each n-th output; 0: never
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

/// Some cells or boundary faces of a body as a mesh, for what is written of them; without faces. Its points are those of these
/// cells or faces, each owned by the rank that owns it in the body.
struct MeshPart {
  mesh::Mesh mesh;             ///< ids are those of the body, cell_id of a surface its boundary_id
  std::vector<Index> points;   ///< per local point: that of the body
  std::vector<Index> entries;  ///< per local cell: the cell or face of the body
  std::vector<Vec3> places;    ///< of the points [m]
};

/// Part of the owned cells with a flag. `places`: per local point of the body [m]. Collective.
MeshPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags);
/// Flags of the owned cells the mean of whose points lies in a box. `places`: per local point [m].
std::vector<std::uint8_t> cells_within(const mesh::Mesh& mesh, std::span<const Vec3> places,
                                       const FieldChoice::Box& box);
/// The faces of one patch as cells of one dimension less, in their order (edges in 2-D). Collective.
MeshPart make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch);

/// The same field at some of its entries; its values go to `values`.
OutputField picked(const OutputField& field, std::span<const Index> entries, std::vector<double>& values);

}  // namespace couplet::io
