// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::mesh {

/// What a field has values of, in the order in which a rank has them. `cells`, `points` and `boundary` are with their
/// ghosts, `owned_cells` and `owned_boundary` without; `interior_faces` and `flux_faces` are those of Mesh, of which
/// neighbouring ranks share the faces between their cells; the rank of a face's owner owns it.
enum class Entries : std::uint8_t {
  cells,
  owned_cells,
  points,
  boundary,
  owned_boundary,
  interior_faces,
  flux_faces
};
constexpr std::size_t n_kinds_of_entries = 7;

std::size_t count_of(const Mesh& mesh, Entries entries);

/// Orders of the entries of a mesh that do not depend on the number of ranks: by their numbers in the mesh file, faces
/// between cells by the cell that owns them. Each is made when it is first asked for (collective) and kept.
class OrderOfEntries {
 public:
  /// By reference.
  explicit OrderOfEntries(const Mesh& mesh) : mesh_(&mesh) {}
  const Mesh& mesh() const { return *mesh_; }
  const parallel::GlobalOrder& of(Entries entries);

 private:
  const Mesh* mesh_;
  std::array<std::optional<parallel::GlobalOrder>, n_kinds_of_entries> orders_;
};

/// Which mesh this is: numbers of cells, points and boundary faces, and a digest of how they hang together; the same on
/// any number of ranks. Collective.
std::array<std::int64_t, 4> identity_of(const Mesh& mesh);
/// Which cells, points and boundary faces this rank has, and in which order.
std::uint64_t share_of_rank(const Mesh& mesh);

}  // namespace couplet::mesh
