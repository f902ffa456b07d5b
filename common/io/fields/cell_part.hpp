// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/io/fields/field_choice.hpp"
#include "common/io/fields/output_field.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

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

}  // namespace couplet::io
