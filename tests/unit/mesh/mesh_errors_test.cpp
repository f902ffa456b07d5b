// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/load.hpp"
#include "support.hpp"

namespace couplet::mesh_errors_test {
using namespace mesh;

using ::testing::EndsWith;
using ::testing::HasSubstr;

RawMesh squares() { return make_box(BoxCells::quadrilaterals, {2, 1, 0}, {0, 0, 0}, {2, 1, 0}); }
std::string error_of(const RawMesh& raw) {
  return support::error_of([&] { distribute(MPI_COMM_SELF, raw); });
}

TEST(MeshErrors, boundary_faces_without_patch_are_the_patch_rest) {
  RawMesh raw = squares();
  raw.boundary_points.offset.pop_back();
  raw.boundary_points.index.resize(raw.boundary_points.index.size() - 2);
  raw.boundary_patch.pop_back();
  const auto rest_of_mesh = [&] {
    ::testing::internal::CaptureStdout();
    const auto [mesh, geometry] = distribute(MPI_COMM_SELF, raw);
    const Patch* rest = mesh.find_patch("rest");
    const std::string log = ::testing::internal::GetCapturedStdout();
    double area = 0;
    for (Index f = rest->first; f < rest->first + rest->count; ++f) area += geometry.face_area[f].norm();
    return std::pair(area, log);
  };
  auto [area, log] = rest_of_mesh();
  EXPECT_DOUBLE_EQ(area, 1);
  EXPECT_THAT(log, HasSubstr("1 boundary face in no physical group forms the patch 'rest', at (1.5, 1). If"));
  raw = make_box(BoxCells::hexahedra, {2, 1, 1}, {0, 0, 0}, {2, 1, 1});
  raw.boundary_points = {};
  raw.boundary_patch = {};
  std::tie(area, log) = rest_of_mesh();
  EXPECT_DOUBLE_EQ(area, 10);
  EXPECT_THAT(log,
              HasSubstr("10 boundary faces in no physical group form the patch 'rest', at (0.5, 0.5, 0), "
                        "(0.5, 0.5, 1), (0.5, 0, 0.5), ..."));
}

TEST(MeshErrors, boundary_face_in_two_patches_is_named_with_both) {
  RawMesh raw = squares();
  raw.boundary_points.push_row(raw.boundary_points[0]);
  raw.boundary_patch.push_back(1);
  EXPECT_EQ(raw.patches[raw.boundary_patch[0]], "ymin");
  EXPECT_EQ(
      error_of(raw),
      "The boundary face at (0.5, 0) is in two patches, 'ymin' and 'xmax'. Every boundary face must be in "
      "exactly one patch.");
}

TEST(MeshErrors, patch_between_cells_is_refused) {
  RawMesh raw = squares();
  const Index inner[] = {1, 4};
  raw.boundary_points.push_row(inner);
  raw.boundary_patch.push_back(3);
  EXPECT_EQ(
      error_of(raw),
      "Patch 'ymax' has a face at (1, 0.5) that lies between two cells. A patch must lie on the boundary; "
      "remove the inner surface from the physical group. If there is none, check whether the mesh contains every cell twice.");
}

TEST(MeshErrors, a_cell_in_two_groups_is_named) {
  RawMesh raw = squares();
  raw.zones = {"low", "all"};
  for (Index c = 0; c < 2; ++c) {
    const auto row = raw.cell_points[c];
    raw.cell_points.push_row(std::vector<Index>(row.begin(), row.end()));
    raw.cell_type.push_back(raw.cell_type[0]);
    raw.cell_zone.push_back(1);
  }
  EXPECT_THAT(error_of(raw), HasSubstr("is in two groups, 'low' and 'all'. A cell must be in exactly one."));
  raw.cell_zone = {0, 0, 0, 0};
  EXPECT_THAT(error_of(raw), HasSubstr("The mesh has the quadrilateral at (1, 0.5) twice."));
}

TEST(MeshErrors, patch_off_the_cells_is_refused) {
  RawMesh raw = squares();
  const Index across[] = {0, 2};
  raw.boundary_points.push_row(across);
  raw.boundary_patch.push_back(3);
  EXPECT_THAT(error_of(raw), HasSubstr("Patch 'ymax' has a face at (1, 0) that belongs to no cell."));
}

TEST(MeshErrors, third_cell_on_a_face_is_refused) {
  RawMesh raw = squares();
  raw.points.insert(raw.points.end(), {{3, 0.5, 0}, {3, 0.7, 0}});
  const Index third[] = {1, 6, 7, 4};
  raw.cell_points.push_row(third);
  raw.cell_type.push_back(CellType::quadrilateral);
  raw.cell_zone.push_back(0);
  EXPECT_EQ(error_of(raw),
            "3 cells share the face at (1, 0.5), but a face has at most two cells; the mesh has duplicate or "
            "overlapping cells.");
}

TEST(MeshErrors, plane_mesh_out_of_its_plane_is_refused) {
  RawMesh raw = squares();
  raw.points[4][2] = 0.25;
  EXPECT_EQ(error_of(raw),
            "The 2-D mesh has a point at (1, 1, 0.25). A 2-D mesh must lie in the plane z = 0; rotate or "
            "shift it there.");
}

TEST(MeshErrors, cell_without_volume_is_refused) {
  RawMesh raw = squares();
  raw.points[4] = raw.points[1];
  raw.points[5] = raw.points[2];
  EXPECT_THAT(error_of(raw), HasSubstr("Cell 1 at (1, 0) has zero volume"));
}

TEST(MeshErrors, mesh_without_cells_is_refused) {
  RawMesh raw;
  EXPECT_EQ(
      error_of(raw),
      "The mesh has no 3-D cells. Put the volume into a physical group; otherwise gmsh does not save them.");
}

const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string nodes = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";

struct BadFile {
  const char* name;
  std::string text, message;
};

class MshErrors : public ::testing::TestWithParam<BadFile> {};
INSTANTIATE_TEST_SUITE_P(
    Files, MshErrors,
    ::testing::Values(
        BadFile{"empty", "", ":1: This is not a gmsh .msh file: it does not start with $MeshFormat."},
        BadFile{
            "other_version", "$MeshFormat\n4 0 8\n$EndMeshFormat\n",
            ":2: Version 4 of the .msh format is not supported. Save the mesh as version 4.1 (gmsh -format msh41)."},
        BadFile{
            "polygon", head + nodes + "$Elements\n1\n1 34 2 1 1 1 2 3 4 5 6\n$EndElements\n",
            ":12: Element type 34 is not supported: expected a line, triangle, quadrilateral, tetrahedron, "
            "hexahedron, prism or pyramid."},
        BadFile{"unknown_node", head + nodes + "$Elements\n1\n1 2 2 1 1 1 2 4\n$EndElements\n",
                ":12: An element uses node 4, which is not in $Nodes."},
        BadFile{"node_twice", head + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n", ":7: Duplicate node 1."},
        BadFile{"not_a_number", head + "$Nodes\n1\n1 0 zero 0\n$EndNodes\n",
                ":6: Expected a number, found 'zero'."},
        BadFile{"not_finite", head + "$Nodes\n2\n1 0 0 0\n2 1 nan 0\n$EndNodes\n",
                ":7: Expected a finite number, found 'nan'."},
        BadFile{"not_whole", head + "$Nodes\n1.5\n1 0 0 0\n$EndNodes\n",
                ":5: Expected a whole number, found '1.5'."},
        BadFile{"truncated", head + "$Nodes\n2\n1 0 0 0\n",
                ":6: The file ends here in the middle of its data. It is incomplete."},
        BadFile{"wrong_count", head + "$Nodes\n1\n1 0 0 0\n2 0 0 0\n$EndNodes\n",
                ":7: Expected $EndNodes here, found '2 0 0 0'. The counts in the section do not match its "
                "content, or the file is incomplete."},
        BadFile{"no_elements", head + nodes,
                ":9: The file has no $Nodes or no $Elements. It is incomplete."}),
    [](const auto& info) { return info.param.name; });

TEST_P(MshErrors, say_what_is_wrong_and_in_which_line) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("bad.msh", GetParam().text);
  EXPECT_EQ(support::error_of([&] { read_msh(file); }), file.string() + GetParam().message);
}

TEST(MshErrorsBinary, truncated_file_names_byte_and_section) {
  const test::TemporaryFolder folder;
  std::ifstream in(test::data / "solid_41_binary.msh", std::ios::binary);
  std::string text(5000, '\0');
  in.read(text.data(), 5000);
  const auto file = folder.write("cut.msh", text);
  const std::string error = support::error_of([&] { read_msh(file); });
  EXPECT_THAT(error, HasSubstr(file.string() + ", byte "));
  EXPECT_THAT(error, EndsWith("in $Nodes: The file ends here in the middle of its data. It is incomplete."));
}

}  // namespace couplet::mesh_errors_test
