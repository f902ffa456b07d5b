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

/// Some cells of a body as a mesh, for what is written of them.
struct CellPart {
  mesh::Mesh mesh;                   ///< ids are those of the body; no faces
  std::vector<Index> points, cells;  ///< per local point or cell: that of the body
  std::vector<Vec3> places;          ///< of the points [m]
};

/// Of the owned cells with a flag. `places`: per local point of the body [m]. Collective.
CellPart make_part(const mesh::Mesh& body, std::span<const Vec3> places,
                   const std::vector<std::uint8_t>& flags);
/// Of the owned cells, by the mean of their points. `places`: per local point [m].
std::vector<std::uint8_t> cells_within(const mesh::Mesh& mesh, std::span<const Vec3> places,
                                       const FieldChoice::Box& box);
/// The same field on the cells or points of the part; its values go to `values`.
OutputField part_of(const OutputField& field, const CellPart& part, std::vector<double>& values);

/// The faces of one patch as a mesh, for what is written of them. Its cells are the patch's faces on this rank in their
/// order (edges in 2-D), its points those of these faces, each owned by the rank that owns it in the body.
struct SurfaceMesh {
  mesh::Mesh mesh;            ///< dim: that of the body less 1; cell_id: boundary_id of the body; no faces
  std::vector<Index> points;  ///< per local point: the local point of the body
  std::vector<Vec3> places;   ///< of the points [m]
};

/// `places`: per local point of the body [m]. Collective.
SurfaceMesh make_surface(const mesh::Mesh& body, std::span<const Vec3> places, const mesh::Patch& patch);

}  // namespace couplet::io
