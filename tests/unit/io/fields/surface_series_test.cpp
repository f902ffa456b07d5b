// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/surface_series.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::surface_series_test {
using namespace io;
using namespace mesh;

using ::testing::HasSubstr;

const double from_start = std::numeric_limits<double>::quiet_NaN();

LoadedMesh box_of(BoxCells cells) {
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  RawMesh raw;
  if (parallel::comm_rank(world) == 0)
    raw = make_box(cells, {5, 3, flat ? 1 : 2}, Vec3::Zero(), Vec3(2, 1, flat ? 0 : 1));
  return distribute(world, raw);
}

/// "height": the face's centre times (1, 10, 100); "place": of the points.
void write(SurfaceSeries& series, const Mesh& mesh, const Geometry& geometry, double time) {
  std::vector<double> height, place;
  for (Index b = 0; b < mesh.boundary.n_owned(); ++b)
    height.push_back(geometry.face_centre[mesh.n_interior + b].dot(Vec3(1, 10, 100)) + time);
  std::vector<Vec3> points = geometry.points;
  for (Vec3& x : points) {
    x[0] += time * x[1];
    for (int d = 0; d < mesh.dim; ++d) place.push_back(x[d]);
  }
  for (std::size_t i = 0; i < series.patches().size(); ++i)
    series.write(i, time, points,
                 {{"height", "m", OutputField::Place::cells, 1, height},
                  {"place", "m", OutputField::Place::points, mesh.dim, place}});
  MPI_Barrier(world);
}

struct Read {
  std::vector<std::int64_t> cells, point_id;
  std::vector<double> height, place, coordinates;
  explicit Read(const std::filesystem::path& name, std::uint64_t width,
                const std::string& step = "steps/000000") {
    const hdf5::Reader file(name, "output");
    EXPECT_EQ(file.text("/", "format"), "couplet surface");
    const std::uint64_t n = file.rows("mesh/cell-id", 1), np = file.rows("mesh/point-id", 1);
    cells.resize(n * width), point_id.resize(np), height.resize(n), place.resize(3 * np),
        coordinates.resize(3 * np);
    file.read("mesh/cells", {0, n, n, width}, cells.data());
    file.read("mesh/point-id", {0, np, np, 1}, point_id.data());
    file.read(step + "/cells/height", {0, n, n, 1}, height.data());
    file.read(step + "/points/place", {0, np, np, 3}, place.data());
    file.read(step + "/coordinates", {0, np, np, 3}, coordinates.data());
  }
};

TEST(SurfaceSeries, each_face_and_point_of_a_patch_is_written_once_where_it_is) {
  const support::SharedFolder scratch;
  const std::map<BoxCells, std::uint64_t> width{{BoxCells::quadrilaterals, 2},
                                                {BoxCells::triangles, 2},
                                                {BoxCells::hexahedra, 4},
                                                {BoxCells::tetrahedra, 3}};
  for (const auto& [cells, corners] : width) {
    const auto [mesh, geometry] = box_of(cells);
    SurfaceSeries series(mesh, geometry.points, {"xmax", "ymin"}, "output.surfaces");
    series.open(scratch / "", true, from_start);
    write(series, mesh, geometry, 0.5);
    const Read floor(scratch / "surface-ymin.h5", corners);
    const std::size_t along = mesh.dim == 2 ? 5 : 5 * 2 * (corners == 3 ? 2 : 1),
                      points = mesh.dim == 2 ? 6 : 6 * 3;
    EXPECT_EQ(floor.height.size(), along);
    EXPECT_EQ(floor.point_id.size(), points);
    EXPECT_EQ(std::set(floor.point_id.begin(), floor.point_id.end()).size(), points);
    EXPECT_EQ(floor.place, floor.coordinates);
    for (std::size_t c = 0; c < along; ++c) {  // the points of a face lie around the place whose value it has
      Vec3 mean = Vec3::Zero();
      for (std::size_t k = 0; k < corners; ++k)
        for (int d = 0; d < 3; ++d)
          mean[d] += floor.coordinates.at(3 * std::size_t(floor.cells[c * corners + k]) + std::size_t(d)) /
                     double(corners);
      EXPECT_NEAR(floor.height[c], mean.dot(Vec3(1, 10, 100)) + 0.5, 1e-12);
    }
    const Read side(scratch / "surface-xmax.h5", corners);
    for (const double height : side.height) EXPECT_GT(height, 2.5);
    MPI_Barrier(world);
  }
}

TEST(SurfaceSeries, the_index_of_a_plane_scene_holds_edges) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = box_of(BoxCells::triangles);
  SurfaceSeries series(mesh, geometry.points, {"ymin"}, "output.surfaces");
  series.open(scratch / "", false, from_start);
  write(series, mesh, geometry, 0);
  std::ifstream in(scratch / "surface-ymin.xdmf");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("TopologyType=\"Polyline\" NumberOfElements=\"5\" NodesPerElement=\"2\""));
  EXPECT_THAT(text, HasSubstr("Dimensions=\"5 2\">surface-ymin.h5:/mesh/cells"));
  MPI_Barrier(world);
}

TEST(SurfaceSeries, all_stands_for_every_patch_and_points_are_flagged_on_all_ranks) {
  const auto [mesh, geometry] = box_of(BoxCells::hexahedra);
  EXPECT_EQ(SurfaceSeries(mesh, geometry.points, {"all"}, "output.surfaces").patches().size(), 6u);
  const SurfaceSeries series(mesh, geometry.points, {"zmin"}, "output.surfaces");
  const auto flags = series.points();
  for (Index v = 0; v < mesh.points.n_local(); ++v)
    EXPECT_EQ(flags[std::size_t(v)], geometry.points[std::size_t(v)].z() == 0 ? 1 : 0) << v;
}

TEST(SurfaceSeries, a_restart_drops_the_later_times_and_goes_on) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = box_of(BoxCells::hexahedra);
  {
    SurfaceSeries series(mesh, geometry.points, {"ymin"}, "output.surfaces");
    series.open(scratch / "", true, from_start);
    for (int i = 0; i < 4; ++i) write(series, mesh, geometry, 0.25 * i);
  }
  SurfaceSeries series(mesh, geometry.points, {"ymin"}, "output.surfaces");
  series.open(scratch / "", true, 0.25);
  write(series, mesh, geometry, 0.4);
  const hdf5::Reader file(scratch / "surface-ymin.h5", "output");
  EXPECT_EQ(file.members("steps").size(), 3u);
  EXPECT_EQ(file.number("steps/000002", "time"), 0.4);
  MPI_Barrier(world);
}

TEST(SurfaceSeries, a_name_that_is_no_patch_is_refused) {
  const auto [mesh, geometry] = box_of(BoxCells::quadrilaterals);
  const auto refused = [&](std::vector<std::string> names) {
    return support::error_of([&] { SurfaceSeries(mesh, geometry.points, names, "output.surfaces"); });
  };
  EXPECT_THAT(refused({"ymin", "xmx"}),
              HasSubstr("output.surfaces: 'xmx' is not a patch of the boundary. Did you mean 'xmax'?"));
}

TEST(SurfaceSeries, a_file_of_another_kind_is_not_continued) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = box_of(BoxCells::quadrilaterals);
  { FieldWriter writer(mesh, geometry.points, scratch / "", "surface-ymin", true, from_start); }
  SurfaceSeries series(mesh, geometry.points, {"ymin"}, "output.surfaces");
  series.open(scratch / "", true, 0.5);
  EXPECT_TRUE(std::filesystem::exists(scratch / "surface-ymin.h5.aside"));
}

}  // namespace couplet::surface_series_test
