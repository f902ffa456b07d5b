// SPDX-License-Identifier: Apache-2.0
// The files in data/ were made from the .geo files beside them by gmsh 4.8.4.
#include "common/mesh/load.hpp"
#include "tests/unit/mesh/support.hpp"

namespace couplet::read_msh_test {
using namespace mesh;

class ReadMsh : public ::testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Versions, ReadMsh,
                         ::testing::Values("22_ascii", "22_binary", "41_ascii", "41_binary"),
                         [](const auto& info) { return info.param; });

double volume_of_zone(const Mesh& mesh, const Geometry& geometry, const std::string& zone) {
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    if (mesh.zones[mesh.cell_zone[c]] == zone) volume += geometry.volume[c];
  return volume;
}

Vec3 area_of_patch(const Mesh& mesh, const Geometry& geometry, const std::string& name) {
  const Patch* patch = mesh.find_patch(name);
  Vec3 area = Vec3::Zero();
  for (Index f = patch->first; f < patch->first + patch->count; ++f) area += geometry.face_area[f];
  return area;
}

TEST_P(ReadMsh, plane_mesh_has_its_cells_zones_and_patches) {
  const RawMesh raw = read_msh(test::data / (std::string("plane_") + GetParam() + ".msh"));
  EXPECT_EQ(raw.dim, 2);
  EXPECT_EQ(std::count(raw.cell_type.begin(), raw.cell_type.end(), CellType::quadrilateral), 4);
  EXPECT_EQ(std::count(raw.cell_type.begin(), raw.cell_type.end(), CellType::triangle), 14);
  EXPECT_EQ(raw.zones, (std::vector<std::string>{"stiff", "soft"}));
  EXPECT_EQ(raw.patches, (std::vector<std::string>{"inlet", "outlet", "wall"}));

  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  EXPECT_NEAR(volume_of_zone(mesh, geometry, "stiff"), 1, 1e-14);
  EXPECT_NEAR(volume_of_zone(mesh, geometry, "soft"), 1, 1e-14);
  for (const double v : geometry.volume) EXPECT_GT(v, 0);
  EXPECT_LT((area_of_patch(mesh, geometry, "inlet") - Vec3(-1, 0, 0)).norm(), 1e-14);
  EXPECT_LT((area_of_patch(mesh, geometry, "outlet") - Vec3(1, 0, 0)).norm(), 1e-14);
  EXPECT_EQ(mesh.find_patch("wall")->count, 8);
}

TEST_P(ReadMsh, solid_mesh_of_four_cell_types_has_its_cells_zones_and_patches) {
  const RawMesh raw = read_msh(test::data / (std::string("solid_") + GetParam() + ".msh"));
  EXPECT_EQ(raw.dim, 3);
  const auto count = [&](CellType type) {
    return std::count(raw.cell_type.begin(), raw.cell_type.end(), type);
  };
  EXPECT_EQ(count(CellType::hexahedron), 8);
  EXPECT_EQ(count(CellType::prism), 14);
  EXPECT_EQ(count(CellType::pyramid), 4);
  EXPECT_EQ(count(CellType::tetrahedron), 106);
  EXPECT_EQ(raw.zones, (std::vector<std::string>{"lower", "upper"}));
  EXPECT_EQ(raw.patches, (std::vector<std::string>{"bottom", "top", "sides"}));

  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  EXPECT_NEAR(volume_of_zone(mesh, geometry, "lower"), 1, 1e-13);
  EXPECT_NEAR(volume_of_zone(mesh, geometry, "upper"), 1.5, 1e-13);
  for (const double v : geometry.volume) EXPECT_GT(v, 0);
  EXPECT_LT((area_of_patch(mesh, geometry, "bottom") - Vec3(0, 0, -1)).norm(), 1e-14);
  EXPECT_LT((area_of_patch(mesh, geometry, "top") - Vec3(0, 0, 1)).norm(), 1e-14);
}

TEST_P(ReadMsh, all_versions_of_a_mesh_are_the_same) {
  for (const std::string name : {"plane_", "solid_"}) {
    const RawMesh one = read_msh(test::data / (name + GetParam() + ".msh"));
    const RawMesh other = read_msh(test::data / (name + "22_ascii.msh"));
    EXPECT_EQ(one.cell_points.size(), other.cell_points.size());
    ASSERT_EQ(one.points.size(), other.points.size());
    double largest = 0;
    const auto less = [](const Vec3& a, const Vec3& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    std::vector<Vec3> a = one.points, b = other.points;
    std::sort(a.begin(), a.end(), less);
    std::sort(b.begin(), b.end(), less);
    for (std::size_t p = 0; p < a.size(); ++p) largest = std::max(largest, (a[p] - b[p]).norm());
    EXPECT_LT(largest, 1e-15);
  }
}

TEST(ReadMshGroups, without_names_are_called_after_their_tags_and_cells_without_group_are_default) {
  const test::TemporaryFolder folder;
  const RawMesh raw = read_msh(folder.write("one.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
10 5 5 0
1 0 0 0
2 1 0 0
3 0 1 0
$EndNodes
$Elements
4
1 1 2 7 1 1 2
2 1 2 9 2 2 3
3 1 2 7 3 3 1
4 2 2 0 1 1 3 2
$EndElements
)"));
  EXPECT_EQ(raw.patches, (std::vector<std::string>{"physical_7", "physical_9"}));
  EXPECT_EQ(raw.zones, (std::vector<std::string>{"default"}));
  const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
  EXPECT_EQ(mesh.points.n_local(), 3) << "the point that no cell uses is dropped";
  EXPECT_NEAR(geometry.volume[0], 0.5, 1e-15) << "the clockwise triangle is turned";
}

}  // namespace couplet::read_msh_test
