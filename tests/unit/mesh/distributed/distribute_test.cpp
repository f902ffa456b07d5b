// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/load.hpp"
#include "tests/unit/mesh/support.hpp"

namespace couplet::distribute_test {
using namespace mesh;
using namespace parallel;

class Distribute : public ::testing::TestWithParam<test::Box> {
 protected:
  RawMesh raw = test::distorted_box(GetParam().cells);
  const LoadedMesh loaded = distribute(MPI_COMM_WORLD, raw);
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
};

INSTANTIATE_TEST_SUITE_P(Boxes, Distribute, ::testing::ValuesIn(test::boxes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(Distribute, every_cell_point_and_boundary_face_is_owned_exactly_once) {
  const auto owned_ids = [&](const IndexMap& map, const std::vector<GlobalIndex>& ids) {
    auto all = all_gather(mesh.comm, std::vector<GlobalIndex>(ids.begin(), ids.begin() + map.n_owned()));
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto all_numbers = [](std::size_t n) {
    std::vector<GlobalIndex> numbers(n);
    for (std::size_t i = 0; i < n; ++i) numbers[i] = GlobalIndex(i);
    return numbers;
  };
  EXPECT_EQ(owned_ids(mesh.cells, mesh.cell_id), all_numbers(raw.cell_type.size()));
  EXPECT_EQ(owned_ids(mesh.points, mesh.point_id), all_numbers(raw.points.size()));
  EXPECT_EQ(owned_ids(mesh.boundary, mesh.boundary_id), all_numbers(raw.boundary_patch.size()));
}

TEST_P(Distribute, ghosts_carry_the_ids_of_their_owners) {
  const auto check = [&](const IndexMap& map, const std::vector<GlobalIndex>& ids) {
    ASSERT_EQ(ids.size(), std::size_t(map.n_local()));
    std::vector<GlobalIndex> sent(ids);
    std::fill(sent.begin() + map.n_owned(), sent.end(), -1);
    map.update_ghosts(std::span<GlobalIndex>(sent));
    EXPECT_EQ(sent, ids);
  };
  check(mesh.cells, mesh.cell_id);
  check(mesh.points, mesh.point_id);
  check(mesh.boundary, mesh.boundary_id);
}

TEST_P(Distribute,
       ghosts_are_all_cells_that_share_a_vertex_with_an_owned_cell_and_a_second_ring_at_wide_points) {
  std::set<GlobalIndex> owned(mesh.cell_id.begin(), mesh.cell_id.begin() + mesh.cells.n_owned());
  std::set<GlobalIndex> ghosts(mesh.cell_id.begin() + mesh.cells.n_owned(), mesh.cell_id.end());
  std::set<Index> touched;
  for (const GlobalIndex c : owned)
    for (const Index p : raw.cell_points[Index(c)]) touched.insert(p);
  std::set<Index> wide, around_wide;
  for (const Index p : mesh.wide_points) wide.insert(Index(mesh.point_id[p]));
  for (Index c = 0; c < raw.cell_points.size(); ++c)
    for (const Index p : raw.cell_points[c])
      if (wide.count(p) && touched.count(p))
        around_wide.insert(raw.cell_points[c].begin(), raw.cell_points[c].end());
  touched.insert(around_wide.begin(), around_wide.end());
  std::set<GlobalIndex> expected;
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    const auto points = raw.cell_points[c];
    if (owned.count(c) == 0 &&
        std::any_of(points.begin(), points.end(), [&](Index p) { return touched.count(p); }))
      expected.insert(c);
  }
  EXPECT_EQ(ghosts, expected);
  EXPECT_EQ(comm_size(mesh.comm) == 1, ghosts.empty());
}

TEST_P(Distribute, cells_keep_their_points_and_type) {
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    const Index whole = Index(mesh.cell_id[c]);
    EXPECT_EQ(mesh.cell_type[c], raw.cell_type[whole]);
    std::multiset<GlobalIndex> here, there(raw.cell_points[whole].begin(), raw.cell_points[whole].end());
    for (const Index p : mesh.cell_points[c]) {
      here.insert(mesh.point_id[p]);
      EXPECT_EQ(geometry.points[p], raw.points[mesh.point_id[p]]);
    }
    EXPECT_EQ(here, there);
  }
}

TEST_P(Distribute, interior_faces_are_sorted_and_owned_by_the_smaller_id) {
  for (Index f = 0; f < mesh.n_interior; ++f) {
    EXPECT_LT(mesh.cell_id[mesh.owner[f]], mesh.cell_id[mesh.neighbour[f]]);
    EXPECT_TRUE(mesh.owner[f] < mesh.cells.n_owned() || mesh.neighbour[f] < mesh.cells.n_owned());
    if (f > 0) {
      EXPECT_LT(std::pair(mesh.owner[f - 1], mesh.neighbour[f - 1]),
                std::pair(mesh.owner[f], mesh.neighbour[f]));
    }
  }
}

TEST_P(Distribute, patches_are_complete_and_in_the_order_of_the_file) {
  ASSERT_EQ(mesh.patches.size(), raw.patches.size());
  std::vector<GlobalIndex> expected(raw.patches.size(), 0);
  for (const int p : raw.boundary_patch) ++expected[p];
  Index next = mesh.n_interior;
  for (std::size_t p = 0; p < raw.patches.size(); ++p) {
    EXPECT_EQ(mesh.patches[p].name, raw.patches[p]);
    EXPECT_EQ(mesh.patches[p].first, next);
    next += mesh.patches[p].count;
    EXPECT_EQ(sum(mesh.comm, GlobalIndex(mesh.patches[p].count)), expected[p]);
  }
  EXPECT_EQ(next, mesh.n_flux_faces());
  for (const Patch& patch : mesh.patches) {
    EXPECT_EQ(patch.ghost_first, next);
    next += patch.ghost_count;
    // Faces of the box lie where their names say, those of ghosts too.
    const int axis = patch.name[0] - 'x';
    const double plane = patch.name.substr(1) == "min" ? test::lower[axis] : test::upper[axis];
    for (Index i = 0; i < patch.count + patch.ghost_count; ++i) {
      const Index f = i < patch.count ? patch.first + i : patch.ghost_first + i - patch.count;
      EXPECT_NEAR(geometry.face_centre[f][axis], plane, 1e-14);
      EXPECT_EQ(mesh.owner[f] < mesh.cells.n_owned(), i < patch.count);
    }
  }
  EXPECT_EQ(next, mesh.n_faces());
}

TEST_P(Distribute, every_boundary_face_of_a_ghost_is_there) {
  std::size_t expected = 0;
  const std::set<GlobalIndex> ghosts(mesh.cell_id.begin() + mesh.cells.n_owned(), mesh.cell_id.end());
  // Boundary faces per cell of the whole mesh, counted on one rank's own copy.
  const Mesh whole = distribute(MPI_COMM_SELF, raw).mesh;
  for (Index f = whole.n_interior; f < whole.n_faces(); ++f)
    expected += ghosts.count(whole.cell_id[whole.owner[f]]);
  EXPECT_EQ(std::size_t(mesh.boundary.n_ghost()), expected);
}

TEST(DistributeTiny, mesh_of_one_cell_a_rank_is_whole) {
  const int size = comm_size(MPI_COMM_WORLD);
  const auto [mesh, geometry] = distribute(
      MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {size, 1, 0}, Vec3::Zero(), Vec3(size, 1, 0)));
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  EXPECT_NEAR(sum(MPI_COMM_WORLD, volume), size, 1e-14);
  EXPECT_EQ(mesh.cells.n_global(), size);
  EXPECT_EQ(mesh.points.n_global(), 2 * (size + 1));
}

}  // namespace couplet::distribute_test
