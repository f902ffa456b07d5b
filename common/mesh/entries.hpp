// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/mesh/mesh.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::mesh {

/// Entities on which a field has values, in the local order. `cells`, `points` and `boundary` include ghosts;
/// `owned_cells` and `owned_boundary` do not. `interior_faces` and `flux_faces` are those of Mesh.
/// Neighboring ranks share the faces between their cells, which belong to the rank of the face's owner cell.
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

/// Orders of mesh entities that do not depend on the number of ranks. They follow the numbers in the mesh
/// file; interior faces follow their owner cells. Each order is created on first use (collective).
class OrderOfEntries {
 public:
  /// Keeps a reference to `mesh`.
  explicit OrderOfEntries(const Mesh& mesh) : mesh_(&mesh) {}
  const Mesh& mesh() const { return *mesh_; }
  const parallel::GlobalOrder& of(Entries entries);

 private:
  const Mesh* mesh_;
  std::array<std::optional<parallel::GlobalOrder>, n_kinds_of_entries> orders_;
};

/// Fingerprint of a mesh: numbers of cells, points and boundary faces, and a digest of the connectivity. It
/// does not depend on the number of ranks. Collective.
std::array<std::int64_t, 4> identity_of(const Mesh& mesh);
/// Digest of the cells, points and boundary faces of this rank and of their order.
std::uint64_t share_of_rank(const Mesh& mesh);

}  // namespace couplet::mesh
