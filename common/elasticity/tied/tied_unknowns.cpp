// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/tied/tied_unknowns.hpp"

#include <algorithm>

#include "common/fv/nodes.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {

TiedUnknowns::TiedUnknowns(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : node_(fv::number_nodes(mesh, rows.unknown_faces())),
      point_(std::size_t(mesh.points.n_local()), -1),
      n_nodes_(std::size_t(mesh.cells.n_owned()) + rows.unknown_faces().size()) {
  for (Index v = 0; v < mesh.points.n_owned(); ++v)
    if (!rows.constraints().is_fixed(v) && !rows.vertices().nodes(v).empty()) points_.push_back(v);
  // What the vertices of the ranks before push the nodes of each rank on by.
  struct Rank {
    GlobalIndex first_node, shift;
  };
  const auto n_points = GlobalIndex(points_.size());
  const Rank here{parallel::exclusive_scan(mesh.comm, GlobalIndex(n_nodes_)),
                  2 * parallel::exclusive_scan(mesh.comm, n_points)};
  const std::vector<Rank> ranks = parallel::all_gather(mesh.comm, std::vector<Rank>{here});
  for (GlobalIndex& n : node_) {
    if (n < 0) continue;
    const auto after = std::ranges::upper_bound(ranks, n, {}, &Rank::first_node);
    n += std::prev(after)->shift;
  }
  const GlobalIndex first_point = here.first_node + here.shift + GlobalIndex(n_nodes_);
  for (std::size_t i = 0; i < points_.size(); ++i)
    point_[std::size_t(points_[i])] = first_point + GlobalIndex(i);
  mesh.points.update_ghosts(std::span<GlobalIndex>(point_));
  first_multiplier_ = first_point + n_points;
}

}  // namespace couplet::elastic
