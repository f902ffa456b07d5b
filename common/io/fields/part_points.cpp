// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/part_points.hpp"

#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

constexpr Index unused = -1;

/// Collective.
parallel::IndexMap map_points(const mesh::Mesh& body, std::span<const Index> points,
                              std::span<const Index> number) {
  std::vector<GlobalIndex> there(number.begin(), number.end());
  body.points.update_ghosts(there);
  std::vector<GlobalIndex> rank(number.size(), parallel::comm_rank(body.comm));
  body.points.update_ghosts(rank);
  std::vector<int> owner;
  std::vector<Index> remote;
  for (const Index v : points) {
    if (v < body.points.n_owned()) continue;
    owner.push_back(static_cast<int>(rank[v]));
    remote.push_back(static_cast<Index>(there[v]));
  }
  return {body.comm, static_cast<Index>(points.size() - owner.size()), owner, remote};
}

}  // namespace

std::vector<Index> number_points(const mesh::Mesh& body, std::vector<double> uses,
                                 std::vector<Index>& points) {
  body.points.add_to_owners(uses);
  std::vector<Index> number(uses.size(), unused);
  for (std::size_t v = 0; v < uses.size(); ++v) {
    if (uses[v] == 0) continue;
    number[v] = static_cast<Index>(points.size());
    points.push_back(static_cast<Index>(v));
  }
  return number;
}

void set_points(mesh::Mesh& part, std::vector<Vec3>& there, const mesh::Mesh& body,
                std::span<const Vec3> places, std::span<const Index> points, std::span<const Index> number) {
  part.comm = body.comm;
  part.points = map_points(body, points, number);
  for (const Index v : points) {
    part.point_id.push_back(body.point_id[v]);
    there.push_back(places[v]);
  }
}

}  // namespace couplet::io
