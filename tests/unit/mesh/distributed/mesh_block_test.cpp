// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/distributed/mesh_block.hpp"

#include "common/mesh/entries.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"
#include "common/mesh/touching_faces.hpp"
#include "tests/support/apart.hpp"
#include "tests/unit/mesh/support.hpp"

namespace couplet::distributed_test {
using namespace mesh;
using namespace parallel;

/// An even share of a mesh that every rank has.
MeshBlock even_block(const RawMesh& raw) { return block_of(MPI_COMM_WORLD, raw, comm_size(MPI_COMM_WORLD)); }

/// The rank of each cell of this rank's block as they are shared out in `mesh`.
std::vector<int> part_of_block(const Mesh& mesh, const MeshBlock& block) {
  std::vector<GlobalIndex> own(mesh.cell_id.begin(), mesh.cell_id.begin() + mesh.cells.n_owned());
  std::vector<GlobalIndex> ranks(own.size(), comm_rank(mesh.comm));
  own = all_gather(mesh.comm, own), ranks = all_gather(mesh.comm, ranks);
  const GlobalIndex first = block.cell_shares.first(comm_rank(mesh.comm));
  std::vector<int> part(block.cells.size(), -1);
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i] >= first && own[i] < first + block.cells.size()) part[own[i] - first] = int(ranks[i]);
  return part;
}

void expect_same_map(const IndexMap& a, const IndexMap& b) {
  EXPECT_EQ(a.n_owned(), b.n_owned());
  EXPECT_EQ(a.global(), b.global());
}

/// Every array alike, bit for bit.
void expect_same(const LoadedMesh& a, const LoadedMesh& b) {
  const Mesh &m = a.mesh, &n = b.mesh;
  EXPECT_EQ(m.dim, n.dim);
  EXPECT_EQ(m.cell_id, n.cell_id);
  EXPECT_EQ(m.point_id, n.point_id);
  EXPECT_EQ(m.boundary_id, n.boundary_id);
  expect_same_map(m.cells, n.cells);
  expect_same_map(m.points, n.points);
  expect_same_map(m.boundary, n.boundary);
  EXPECT_EQ(m.cell_type, n.cell_type);
  EXPECT_EQ(m.cell_points.index, n.cell_points.index);
  EXPECT_EQ(m.cell_points.offset, n.cell_points.offset);
  EXPECT_EQ(m.cell_zone, n.cell_zone);
  EXPECT_EQ(m.zones, n.zones);
  EXPECT_EQ(m.cell_material, n.cell_material);
  EXPECT_EQ(m.n_interior, n.n_interior);
  EXPECT_EQ(m.face_points.index, n.face_points.index);
  EXPECT_EQ(m.face_points.offset, n.face_points.offset);
  EXPECT_EQ(m.owner, n.owner);
  EXPECT_EQ(m.neighbour, n.neighbour);
  EXPECT_EQ(m.twin, n.twin);
  EXPECT_EQ(m.wide_points, n.wide_points);
  ASSERT_EQ(m.neighbour_shift.size(), n.neighbour_shift.size());
  for (std::size_t f = 0; f < m.neighbour_shift.size(); ++f)
    EXPECT_LT((m.neighbour_shift[f] - n.neighbour_shift[f]).norm(), 1e-14);
  ASSERT_EQ(m.patches.size(), n.patches.size());
  for (std::size_t p = 0; p < m.patches.size(); ++p) {
    const Patch &one = m.patches[p], &other = n.patches[p];
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(std::tuple(one.first, one.count, one.ghost_first, one.ghost_count, one.bonded),
              std::tuple(other.first, other.count, other.ghost_first, other.ghost_count, other.bonded));
  }
  EXPECT_EQ(identity_of(m), identity_of(n));
  EXPECT_EQ(a.geometry.points, b.geometry.points);
  if (m.neighbour_shift.empty()) {
    EXPECT_EQ(a.geometry.volume, b.geometry.volume);
    EXPECT_EQ(a.geometry.face_area, b.geometry.face_area);
    EXPECT_EQ(a.geometry.face_centre, b.geometry.face_centre);
  }
}

/// From rank 0 alone and from even blocks, the cells shared out alike.
void expect_same_by_blocks(const RawMesh& raw) {
  const LoadedMesh whole = distribute(MPI_COMM_WORLD, raw);
  MeshBlock block = even_block(raw);
  const std::vector<int> part = part_of_block(whole.mesh, block);
  expect_same(distribute(MPI_COMM_WORLD, std::move(block), part), whole);
}

/// Numbers of cells and points that say nothing of their place, some cells inverted.
RawMesh shuffled(const RawMesh& raw) {
  RawMesh result = raw;
  result.cell_type.clear(), result.cell_zone.clear(), result.cell_points = {};
  const auto n_points = Index(raw.points.size()), n = raw.cell_points.size();
  const auto mixed = [](Index i, Index of) {
    Index step = of / 2 + 1;
    while (std::gcd(step, of) != 1) ++step;
    return Index(GlobalIndex(i) * step % of);
  };
  for (Index p = 0; p < n_points; ++p) result.points[mixed(p, n_points)] = raw.points[p];
  for (Index i = 0; i < n; ++i) {
    const Index c = mixed(i, n);
    std::vector<Index> points(raw.cell_points[c].begin(), raw.cell_points[c].end());
    if (raw.cell_type[c] == CellType::tetrahedron && c % 3 == 0) std::swap(points[1], points[2]);
    for (Index& p : points) p = mixed(p, n_points);
    result.cell_points.push_row(points);
    result.cell_type.push_back(raw.cell_type[c]);
    result.cell_zone.push_back(raw.cell_zone[c]);
  }
  for (Index& p : result.boundary_points.index) p = mixed(p, n_points);
  return result;
}

class Blocks : public ::testing::TestWithParam<test::Box> {};
INSTANTIATE_TEST_SUITE_P(Boxes, Blocks, ::testing::ValuesIn(test::boxes()),
                         [](const auto& info) { return info.param.name; });

TEST_P(Blocks, give_the_parts_that_rank_0_alone_gives_bit_for_bit) {
  expect_same_by_blocks(test::distorted_box(GetParam().cells));
}

TEST_P(Blocks, whose_numbers_are_mixed_up_give_the_same_parts_too) {
  expect_same_by_blocks(shuffled(test::distorted_box(GetParam().cells)));
}

TEST_P(Blocks, with_two_materials_give_the_same_bonded_faces) {
  RawMesh raw = shuffled(test::distorted_box(GetParam().cells));
  raw.zones = {"left", "right"};
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double x = 0;
    for (const Index p : raw.cell_points[c]) x += raw.points[p][0] / double(raw.cell_points[c].size());
    raw.cell_zone[c] = x > 2;
  }
  raw.materials = {{"right"}, {"left"}};
  expect_same_by_blocks(raw);
}

TEST_P(Blocks, with_periodic_patches_give_the_same_faces_and_shifts) {
  RawMesh raw = shuffled(test::distorted_box(GetParam().cells));
  raw.periodic = {{"xmin", "xmax"}};
  expect_same_by_blocks(raw);
}

TEST(BlocksShared, that_are_periodic_in_every_direction_give_the_same_faces_down_to_one_cell) {
  for (const int n : {1, 2, 5}) {
    RawMesh raw = make_box(BoxCells::hexahedra, {n, 4, 3}, test::lower, test::upper);
    raw.periodic = {{"xmin", "xmax"}, {"ymax", "ymin"}, {"zmin", "zmax"}};
    expect_same_by_blocks(raw);
    EXPECT_NO_THROW(distribute(MPI_COMM_WORLD, even_block(raw)));
  }
}

TEST_P(Blocks, shared_out_in_parallel_fill_the_box_with_every_cell_owned_once) {
  const RawMesh raw = make_box(GetParam().cells, {12, 10, 8}, test::lower, test::upper);
  const LoadedMesh alone = distribute(MPI_COMM_SELF, raw);
  const auto [mesh, geometry] = distribute(MPI_COMM_WORLD, even_block(raw));
  EXPECT_EQ(identity_of(mesh), identity_of(alone.mesh));
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  EXPECT_NEAR(sum(MPI_COMM_WORLD, volume), test::box_volume(raw.dim), 1e-12);
  const double even = double(mesh.cells.n_global()) / comm_size(MPI_COMM_WORLD);
  EXPECT_NEAR(mesh.cells.n_owned(), even, 0.1 * even) << "shared out evenly";
}

TEST(BlocksShared, of_a_box_made_in_parallel_are_those_of_the_whole_box) {
  for (const bool tetrahedra : {false, true}) {
    const RawMesh raw = make_box(tetrahedra ? BoxCells::tetrahedra : BoxCells::hexahedra, {5, 4, 3},
                                 test::lower, test::upper);
    const MeshBlock cut = even_block(raw),
                    made = box_block(MPI_COMM_WORLD, {tetrahedra, {5, 4, 3}, test::lower, test::upper});
    EXPECT_EQ(made.points, cut.points);
    EXPECT_EQ(made.cells.type, cut.cells.type);
    EXPECT_EQ(made.cells.points, cut.cells.points);
    EXPECT_EQ(made.patches, cut.patches);
    EXPECT_EQ(all_gather(MPI_COMM_WORLD, made.element_points),
              all_gather(MPI_COMM_WORLD, cut.element_points));
    EXPECT_EQ(all_gather(MPI_COMM_WORLD, made.element_patch), all_gather(MPI_COMM_WORLD, cut.element_patch));
  }
}

TEST(BlocksShared, alike_in_every_call) {
  const RawMesh raw = make_box(BoxCells::tetrahedra, {10, 9, 8}, Vec3::Zero(), Vec3::Ones());
  const auto share = [&] { return distribute(MPI_COMM_WORLD, even_block(raw)).mesh.cell_id; };
  const auto first = share();
  EXPECT_EQ(share(), first);
  EXPECT_EQ(share(), first);
}

TEST(BlocksShared, boundary_faces_without_a_name_are_numbered_alike_on_any_ranks) {
  RawMesh raw = make_box(BoxCells::hexahedra, {3, 3, 3}, Vec3::Zero(), Vec3(3, 3, 3));
  const RawMesh whole = raw;
  raw.boundary_points = {}, raw.boundary_patch = {};
  for (Index e = 0; e < whole.boundary_points.size(); ++e) {
    if (e % 3 == 1) continue;
    raw.boundary_points.push_row(whole.boundary_points[e]);
    raw.boundary_patch.push_back(whole.boundary_patch[e]);
  }
  /// Number and center of each owned face of the patch `rest`, of all ranks.
  const auto rest_of_mesh = [](const LoadedMesh& loaded) {
    std::vector<std::array<double, 4>> faces;
    const Patch* rest = loaded.mesh.find_patch("rest");
    for (Index f = rest->first; f < rest->first + rest->count; ++f) {
      const Vec3& x = loaded.geometry.face_centre[f];
      faces.push_back({double(loaded.mesh.boundary_id[f - loaded.mesh.n_interior]), x[0], x[1], x[2]});
    }
    faces = all_gather(MPI_COMM_WORLD, faces);
    std::ranges::sort(faces);
    return faces;
  };
  const auto faces = rest_of_mesh(distribute(MPI_COMM_WORLD, raw));
  ASSERT_EQ(faces.size(), 18u);
  for (std::size_t i = 0; i < faces.size(); ++i) EXPECT_EQ(faces[i][0], double(36 + i));
  EXPECT_EQ(rest_of_mesh(distribute(MPI_COMM_WORLD, even_block(raw))), faces);
  EXPECT_EQ(rest_of_mesh(distribute(MPI_COMM_SELF, raw)).size(),
            18u * std::size_t(comm_size(MPI_COMM_WORLD)));
}

/// The words about the same mistake, found on rank 0 alone and in even blocks.
void expect_same_error(const RawMesh& raw, const std::string& words) {
  const std::string whole = support::error_of([&] { distribute(MPI_COMM_WORLD, raw); });
  EXPECT_THAT(whole, ::testing::HasSubstr(words));
  EXPECT_EQ(support::error_of([&] { distribute(MPI_COMM_WORLD, even_block(raw)); }), whole);
}

RawMesh box() { return make_box(BoxCells::hexahedra, {3, 3, 3}, Vec3::Zero(), Vec3(3, 3, 3)); }

TEST(BlocksOfWrongMeshes, are_refused_in_the_words_of_rank_0_alone) {
  RawMesh raw = box();
  raw.boundary_points.push_row(box().boundary_points[7]);
  raw.boundary_patch.push_back((raw.boundary_patch[7] + 1) % 6);
  expect_same_error(raw, "is in two patches");

  raw = box();
  const std::vector<Index> first(raw.cell_points.index.begin(),
                                 raw.cell_points.index.begin() + 8);  // its face at x = 1 lies inside
  raw.boundary_points.push_row(std::vector<Index>{first[1], first[2], first[6], first[5]});
  raw.boundary_patch.push_back(0);
  expect_same_error(raw, "lies between two cells");

  raw = box();
  raw.boundary_points.push_row(std::vector<Index>{first[0], first[2], first[6], first[5]});
  raw.boundary_patch.push_back(0);
  expect_same_error(raw, "belongs to no cell");

  raw = box();
  raw.points[raw.cell_points[20][0]] = raw.points[raw.cell_points[20][1]];
  for (const Index p : raw.cell_points[20]) raw.points[p][2] = 1;
  expect_same_error(raw, "has zero volume");

  raw = box();
  raw.materials = {{"here"}, {"default"}};
  expect_same_error(raw, "no zone 'here'");

  raw = make_box(BoxCells::triangles, {4, 4, 0}, Vec3::Zero(), Vec3(1, 1, 0));
  raw.points[24][2] = 1e-3;
  expect_same_error(raw, "plane z = 0");
}

TEST(BlocksOfWrongMeshes, of_a_face_that_three_cells_share_are_refused_wherever_the_third_is) {
  using Words = ::testing::Matcher<const std::string&>;
  const Words many_cells = ::testing::HasSubstr("cells share the face at");
  const Words wrong_in_a_patch = ::testing::AnyOf(many_cells, ::testing::HasSubstr("lies between two cells"));
  for (const auto& [at, is_in_a_patch] : {std::pair(0, false), {80, true}, {13, true}, {161, false}}) {
    RawMesh raw = make_box(BoxCells::tetrahedra, {3, 3, 3}, Vec3::Zero(), Vec3(3, 3, 3));
    const std::vector<Index> cell(raw.cell_points[at].begin(), raw.cell_points[at].end());
    const auto top = Index(raw.points.size());  // a tetrahedron more on an inner face
    raw.points.push_back(Vec3(7, 8, 9));
    raw.cell_points.push_row(std::vector<Index>{cell[0], cell[1], cell[3], top});
    raw.cell_type.push_back(CellType::tetrahedron);
    raw.cell_zone.push_back(0);
    const auto side = [&](Index a, Index b) {
      raw.boundary_points.push_row(std::vector<Index>{a, b, top});
      raw.boundary_patch.push_back(0);
    };
    side(cell[0], cell[1]), side(cell[1], cell[3]), side(cell[3], cell[0]);
    if (is_in_a_patch) {
      raw.boundary_points.push_row(std::vector<Index>{cell[0], cell[1], cell[3]});
      raw.boundary_patch.push_back(0);
    }
    EXPECT_THAT(support::error_of([&] { distribute(MPI_COMM_WORLD, even_block(raw)); }),
                is_in_a_patch ? wrong_in_a_patch : many_cells);
  }
}

TEST(BlocksOfWrongMeshes, whose_periodic_patches_do_not_match_are_refused_in_the_same_words) {
  RawMesh raw = box();
  raw.periodic = {{"xmin", "outlet"}};
  expect_same_error(raw, "The periodic patch 'outlet' does not exist");

  raw.periodic = {{"xmin", "xmax"}};
  for (int& patch : raw.boundary_patch)
    if (patch == 0) {
      patch = 2;
      break;
    }
  expect_same_error(raw, "have 8 and 9 faces");

  raw = box();
  raw.periodic = {{"xmin", "xmax"}};
  for (Vec3& x : raw.points)
    if (x == Vec3(3, 1, 1)) x[1] += 0.2;
  expect_same_error(raw, "has no match on 'xmax'");
}

TEST(BlocksOfWrongMeshes, with_fewer_cells_than_ranks_are_refused) {
  if (comm_size(MPI_COMM_WORLD) == 1) GTEST_SKIP();
  const RawMesh raw = make_box(BoxCells::quadrilaterals, {1, 1, 0}, Vec3::Zero(), Vec3(1, 1, 0));
  expect_same_error(raw, "Start fewer processes");
}

/// A box whose halves on both sides of x = 0 share no points, but touch.
RawMesh torn_box(BoxCells cells) {
  RawMesh raw = make_box(cells, {4, 3, 2}, {-1, 0, 0}, {1, 1, 1});
  const auto n = Index(raw.points.size());
  std::map<Index, Index> copy;
  for (Index c = 0; c < raw.cell_points.size(); ++c) {
    double x = 0;
    for (const Index v : raw.cell_points[c]) x += raw.points[v][0];
    for (Index i = raw.cell_points.offset[c]; x > 0 && i < raw.cell_points.offset[c + 1]; ++i) {
      Index& v = raw.cell_points.index[i];
      if (std::abs(raw.points[v][0]) > 1e-9) continue;
      const auto [at, is_new] = copy.try_emplace(v, Index(raw.points.size()));
      if (is_new) raw.points.push_back(Vec3(raw.points[v]));
      v = at->second;
    }
  }
  raw.patches = {"skin", "left", "right"};
  raw.boundary_points = outer_faces(raw);
  raw.boundary_patch.clear();
  for (Index f = 0; f < raw.boundary_points.size(); ++f) {
    const auto points = raw.boundary_points[f];
    const bool inside =
        std::ranges::all_of(points, [&](Index v) { return std::abs(raw.points[v][0]) < 1e-9; });
    raw.boundary_patch.push_back(!inside ? 0 : points[0] < n ? 1 : 2);
  }
  return raw;
}

LoadedMesh load(const RawMesh& raw, bool tie) {
  MeshBlock block = even_block(raw);
  block.tie = tie;
  return load_block(MPI_COMM_WORLD, std::move(block), "torn", 1);
}

/// Pairs of touching patches as "left right 6 alike at (0, 0.5, 0.5)", one per line.
std::string touching(const LoadedMesh& loaded) {
  std::string text;
  for (const TouchingFaces& t : find_touching_faces(loaded.mesh, loaded.geometry))
    text += fmt::format("{} {} {}{}\n", t.patch, t.other, t.count, t.alike ? " alike" : "");
  return text;
}

TEST(TouchingFaces, are_found_and_tied_on_all_cells) {
  for (const test::Box& box : test::boxes()) {
    SCOPED_TRACE(box.name);
    const RawMesh raw = torn_box(box.cells);
    const auto faces = std::ranges::count(raw.boundary_patch, 1);
    EXPECT_EQ(touching(load(raw, false)), fmt::format("left right {} alike\n", faces));
    const LoadedMesh tied = load(raw, true);
    const RawMesh whole = make_box(box.cells, {4, 3, 2}, {-1, 0, 0}, {1, 1, 1});
    EXPECT_EQ(touching(tied), "");
    EXPECT_EQ(tied.mesh.points.n_global(), std::ssize(whole.points));
    EXPECT_EQ(tied.mesh.boundary.n_global(), std::ssize(whole.boundary_patch));
    EXPECT_EQ(touching(load(whole, false)), "");
  }
}

/// Two squares side by side, `gap` apart, the second one with n cells per side.
RawMesh two_squares(int n, double gap) {
  return support::beside(make_box(BoxCells::quadrilaterals, {4, 4, 1}, {0, 0, 0}, {1, 1, 0}),
                         make_box(BoxCells::quadrilaterals, {n, n, 1}, {1 + gap, 0, 0}, {2 + gap, 1, 0}));
}

TEST(TouchingFaces, are_found_where_the_meshes_differ_but_not_across_a_gap) {
  for (const bool tie : {false, true}) {
    EXPECT_THAT(touching(load(two_squares(8, 0), tie)), ::testing::MatchesRegex("xmin xmax [0-9]+\n"));
    EXPECT_THAT(touching(load(two_squares(5, 0), tie)), ::testing::MatchesRegex("xmin xmax [0-9]+\n"));
    EXPECT_EQ(touching(load(two_squares(4, 1e-3), tie)), "");
  }
  EXPECT_EQ(touching(load(two_squares(4, 0), false)), "xmin xmax 4 alike\n");
  EXPECT_EQ(touching(load(two_squares(4, 0), true)), "");
}

}  // namespace couplet::distributed_test
