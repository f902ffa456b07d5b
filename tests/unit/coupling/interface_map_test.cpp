// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/interface_map.hpp"

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::interface_map_test {
using namespace coupling;
using namespace mesh;

class InterfaceMapOf : public ::testing::TestWithParam<BoxCells> {
 protected:
  InterfaceMapOf() {
    raw = make_box(GetParam(), {4, 5, 3}, Vec3::Zero(), Vec3(2, 1, 1));
    perturb_interior(raw, 0.2, 3);
    loaded = distribute(MPI_COMM_WORLD, raw);
  }
  RawMesh raw;
  LoadedMesh loaded;
  const Mesh& mesh = loaded.mesh;
  const Geometry& geometry = loaded.geometry;
};

const char* name_of_box(const ::testing::TestParamInfo<BoxCells>& info) {
  constexpr const char* names[] = {"quadrilaterals", "triangles", "hexahedra",
                                   "tetrahedra",     "prisms",    "mixed"};
  return names[static_cast<int>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Boxes, InterfaceMapOf,
                         ::testing::Values(BoxCells::quadrilaterals, BoxCells::triangles, BoxCells::hexahedra,
                                           BoxCells::mixed),
                         name_of_box);

double f(const Vec3& x, int component) { return std::sin(3 * x[0] + component) + x[1] * x[1] - 2 * x[2]; }

/// What the ranks have together, by number.
template <class T>
std::map<GlobalIndex, T> together(const std::vector<GlobalIndex>& ids, const std::vector<T>& values) {
  const auto all_ids = parallel::all_gather(MPI_COMM_WORLD, ids);
  const auto all = parallel::all_gather(MPI_COMM_WORLD, values);
  std::map<GlobalIndex, T> result;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_FALSE(result.contains(all_ids[i])) << "twice";
    result[all_ids[i]] = all[i];
  }
  return result;
}

TEST_P(InterfaceMapOf, description_holds_every_vertex_and_face_once) {
  const InterfaceMap map(mesh, {"xmax", "ymin"});
  const Interface interface = map.describe(geometry);
  const auto all_vertices = together(interface.vertex_ids, interface.vertices),
             all_centres = together(interface.face_ids, interface.face_centres),
             all_areas = together(interface.face_ids, interface.face_areas);
  std::vector<GlobalIndex> vertices;
  std::vector<Index> elements;
  for (Index e = 0; e < raw.boundary_points.size(); ++e) {
    const std::string& name = raw.patches[raw.boundary_patch[e]];
    if (name != "xmax" && name != "ymin") continue;
    elements.push_back(e);
    for (const Index p : raw.boundary_points[e]) vertices.push_back(p);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  EXPECT_EQ(interface.dim, raw.dim);
  ASSERT_EQ(all_vertices.size(), vertices.size());
  for (const GlobalIndex v : vertices) EXPECT_EQ(all_vertices.at(v), raw.points[Index(v)]);
  ASSERT_EQ(all_centres.size(), elements.size());
  std::vector<Vec3> expected;
  for (const Index e : elements) {
    Vec3 centre = Vec3::Zero();
    const auto points = raw.boundary_points[e];
    for (const Index p : points) centre += raw.points[p] / double(points.size());
    expected.push_back(centre);
  }
  Vec3 area = Vec3::Zero();
  std::size_t k = 0;
  for (const auto& [id, centre] : all_centres) EXPECT_LT((centre - expected[k++]).norm(), 1e-14);
  for (const auto& [id, a] : all_areas) area += a;
  EXPECT_LT((area - Vec3(1, -2, 0)).norm(), 1e-13) << "out of the participant, on both sides";
}

TEST_P(InterfaceMapOf, faces_name_their_vertices_by_their_places_in_the_list_of_all_ranks) {
  const Interface interface = InterfaceMap(mesh, {"xmax", "ymin"}).describe(geometry);
  const std::vector<Vec3> all = parallel::all_gather(MPI_COMM_WORLD, interface.vertices);
  ASSERT_EQ(interface.face_offset.size(), interface.face_centres.size() + 1);
  for (std::size_t i = 0; i < interface.face_centres.size(); ++i) {
    Vec3 centre = Vec3::Zero();
    const auto n = double(interface.face_offset[i + 1] - interface.face_offset[i]);
    for (auto k = interface.face_offset[i]; k < interface.face_offset[i + 1]; ++k)
      centre += all.at(std::size_t(interface.face_vertices[std::size_t(k)])) / n;
    EXPECT_LT((centre - interface.face_centres[i]).norm(), 1e-14);
  }
}

TEST_P(InterfaceMapOf, values_come_back_from_their_owners_as_they_were_sent) {
  const InterfaceMap map(mesh, {"xmax", "ymin"});
  std::vector<double> at_points, at_faces;
  for (const Index p : map.points())
    for (int c = 0; c < 2; ++c) at_points.push_back(f(geometry.points[p], c));
  for (const Index face : map.faces()) at_faces.push_back(f(geometry.face_centre[face], 0));

  const std::vector<double> vertices = map.gather_vertices(at_points, 2),
                            faces = map.gather_faces(at_faces, 1);
  const Interface interface = map.describe(geometry);
  EXPECT_EQ(vertices.size(), 2 * interface.vertices.size());
  for (std::size_t v = 0; v < interface.vertices.size(); ++v)
    for (int c = 0; c < 2; ++c) EXPECT_EQ(vertices[2 * v + c], f(interface.vertices[v], c));
  for (std::size_t i = 0; i < interface.face_centres.size(); ++i)
    EXPECT_EQ(faces[i], f(interface.face_centres[i], 0));

  EXPECT_EQ(map.scatter_vertices(vertices, 2), at_points);
  EXPECT_EQ(map.scatter_faces(faces, 1), at_faces);
}

TEST_P(InterfaceMapOf, points_are_all_local_points_that_lie_on_the_patches) {
  const InterfaceMap map(mesh, {"xmax"});
  std::vector<Index> expected;
  for (Index p = 0; p < mesh.points.n_local(); ++p)
    if (geometry.points[p][0] == 2) expected.push_back(p);
  EXPECT_EQ(map.points(), expected);
}

TEST_P(InterfaceMapOf, patch_named_twice_counts_once) {
  const InterfaceMap once(mesh, {"ymax"}), twice(mesh, {"ymax", "ymax"});
  EXPECT_EQ(once.faces(), twice.faces());
  EXPECT_EQ(once.describe(geometry).vertices, twice.describe(geometry).vertices);
}

TEST_P(InterfaceMapOf, nothing_given_stands_for_zeros) {
  const InterfaceMap map(mesh, {"xmax"});
  EXPECT_EQ(map.scatter_vertices({}, 2), std::vector<double>(2 * map.points().size(), 0.0));
  EXPECT_EQ(map.scatter_faces({}, 1), std::vector<double>(map.faces().size(), 0.0));
}

TEST(InterfaceMapErrors, data_of_another_size_is_refused) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_SELF, make_box(BoxCells::quadrilaterals, {3, 3, 0}, Vec3::Zero(), Vec3::Ones()));
  const std::string said =
      support::error_of([&] { InterfaceMap(mesh, {"xmax"}).scatter_faces(std::vector<double>(5), 2); });
  EXPECT_EQ(said,
            "The interface data received have 5 values; expected 3 entries of 2 components. Check that both "
            "participants describe the interface they use.");
}

TEST(InterfaceMapErrors, unknown_patch_is_named_with_those_that_exist) {
  const auto [mesh, geometry] =
      distribute(MPI_COMM_WORLD, make_box(BoxCells::quadrilaterals, {3, 3, 0}, Vec3::Zero(), Vec3::Ones()));
  EXPECT_EQ(support::error_of([&] {
              InterfaceMap(mesh, {"xmax", "wet"});
            }),
            "The mesh has no patch 'wet'. Its patches are 'xmin', 'xmax', 'ymin', 'ymax'.");
}

}  // namespace couplet::interface_map_test
