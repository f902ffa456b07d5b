// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/field_writer.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::field_choice_test {
using namespace io;
using namespace mesh;

const double new_series = std::numeric_limits<double>::quiet_NaN();

LoadedMesh cube_of(BoxCells cells, int n) {
  RawMesh raw;
  if (parallel::comm_rank(world) == 0) raw = make_box(cells, {n, n, n}, Vec3::Zero(), Vec3(1, 1, 1));
  return distribute(world, raw);
}

double smooth(const Vec3& x) { return std::floor(8 * x.x()) + 2; }

/// A field on cells, whose values are their ids, and one on points.
void write_both(FieldWriter& writer, const LoadedMesh& m, double time, double shift) {
  std::vector<double> ids, heights;
  for (const GlobalIndex id : m.mesh.cell_id) ids.push_back(double(id));
  std::vector<Vec3> points = m.geometry.points;
  for (Vec3& x : points) {
    heights.push_back(smooth(x));
    x.z() += shift;
  }
  writer.write(time, points,
               {{"id", "-", OutputField::Place::cells, 1, ids},
                {"height", "m", OutputField::Place::points, 1, heights}});
  MPI_Barrier(world);
}

TEST(FieldChoice, in_a_box_are_its_cells_alone_with_their_values_and_moved_points) {
  for (const BoxCells cells : {BoxCells::hexahedra, BoxCells::mixed}) {
    const support::SharedFolder scratch;
    const LoadedMesh m = cube_of(cells, 4);
    FieldChoice choice;
    choice.box = {Vec3(0, 0, 0), Vec3(0.5, 0.5, 1)};
    GlobalIndex inside = 0;
    for (Index c = 0; c < m.mesh.cells.n_owned(); ++c) {
      Vec3 mean = Vec3::Zero();
      for (const Index v : m.mesh.cell_points[c]) mean += m.geometry.points[v];
      mean /= double(m.mesh.cell_points[c].size());
      inside += mean.x() <= 0.5 && mean.y() <= 0.5 ? 1 : 0;
    }
    inside = parallel::sum(world, inside);
    for (const double restart : {new_series, 0.5}) {
      FieldWriter writer(m.mesh, m.geometry.points, scratch / "", "fluid", true, restart, choice);
      write_both(writer, m, std::isnan(restart) ? 0.5 : 1, 0.25);
    }
    const hdf5::Reader file(scratch / "fluid.h5", "output");
    const std::uint64_t n = file.rows("mesh/cell-id", 1), points = file.rows("mesh/point-id", 1);
    EXPECT_EQ(GlobalIndex(n), inside);
    EXPECT_LT(points, std::uint64_t(m.mesh.points.n_global()));
    EXPECT_EQ(file.members("steps").size(), 2u);
    std::vector<std::int64_t> ids(n);
    std::vector<double> id(n), at(3 * points), there(3 * points), height(points);
    file.read("mesh/cell-id", {0, n, n, 1}, ids.data());
    file.read("steps/000001/cells/id", {0, n, n, 1}, id.data());
    file.read("mesh/coordinates", {0, points, points, 3}, at.data());
    file.read("steps/000001/coordinates", {0, points, points, 3}, there.data());
    file.read("steps/000001/points/height", {0, points, points, 1}, height.data());
    for (std::uint64_t c = 0; c < n; ++c) EXPECT_EQ(id[c], double(ids[c]));
    for (std::uint64_t p = 0; p < points; ++p) {
      EXPECT_DOUBLE_EQ(there[3 * p + 2], at[3 * p + 2] + 0.25);
      EXPECT_EQ(height[p], smooth(Vec3(&at[3 * p])));
    }
    MPI_Barrier(world);
  }
}

TEST(FieldChoice, without_a_cell_in_the_box_there_is_no_file) {
  const support::SharedFolder scratch;
  const LoadedMesh m = cube_of(BoxCells::hexahedra, 2);
  FieldChoice choice;
  choice.box = {Vec3(5, 5, 5), Vec3(6, 6, 6)};
  FieldWriter writer(m.mesh, m.geometry.points, scratch / "", "fluid", true, new_series, choice);
  write_both(writer, m, 0.5, 0);
  EXPECT_FALSE(std::filesystem::exists(scratch / "fluid.h5"));
}

TEST(FieldChoice, compressed_fields_are_the_same_and_smaller) {
  const support::SharedFolder scratch;
  const LoadedMesh m = cube_of(BoxCells::hexahedra, 24);
  std::vector<double> values[2];
  for (const int level : {0, 6}) {
    FieldChoice choice;
    choice.compression = level;
    const std::string name = level == 0 ? "plain" : "small";
    FieldWriter writer(m.mesh, m.geometry.points, scratch / "", name, false, new_series, choice);
    for (int i = 0; i < 8; ++i) write_both(writer, m, i, 0);
    const hdf5::Reader file(scratch / (name + ".h5"), "output");
    const std::uint64_t n = file.rows("steps/000007/points/height", 1);
    values[level > 0].resize(n);
    file.read("steps/000007/points/height", {0, n, n, 1}, values[level > 0].data());
  }
  EXPECT_EQ(values[0], values[1]);
  MPI_Barrier(world);
  EXPECT_LT(std::filesystem::file_size(scratch / "small.h5"),
            0.6 * double(std::filesystem::file_size(scratch / "plain.h5")));
}

TEST(FieldChoice, fields_are_due_at_each_nth_output_or_never) {
  FieldChoice choice;
  EXPECT_TRUE(choice.due(3));
  choice.every = 5;
  EXPECT_TRUE(choice.due(0));
  EXPECT_FALSE(choice.due(4));
  EXPECT_TRUE(choice.due(10));
  choice.every = 0;
  EXPECT_FALSE(choice.due(0));
}

}  // namespace couplet::field_choice_test
