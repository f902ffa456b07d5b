// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/field_writer.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::field_writer_test {
using namespace io;
using namespace mesh;

using ::testing::HasSubstr;

const double nan_time = std::numeric_limits<double>::quiet_NaN();

LoadedMesh make_mesh(BoxCells cells, int n = 4, MPI_Comm comm = world) {
  const bool flat = cells == BoxCells::quadrilaterals || cells == BoxCells::triangles;
  RawMesh raw;
  if (parallel::comm_rank(comm) == 0)
    raw = make_box(cells, {n, 3, flat ? 1 : 2}, Vec3::Zero(), Vec3(2, 1, flat ? 0 : 1));
  return distribute(comm, raw);
}

void write(FieldWriter& writer, const Mesh& mesh, const Geometry& geometry, double time) {
  std::vector<double> pressure, velocity;
  for (const GlobalIndex id : mesh.cell_id) {
    pressure.push_back(double(id) + time);
    for (int d = 0; d < mesh.dim; ++d) velocity.push_back(double(10 * id + d));
  }
  std::vector<Vec3> points = geometry.points;
  for (Vec3& x : points) x[0] += time * x[1];
  writer.write(time, points,
               {{"pressure", "Pa", OutputField::Place::cells, 1, pressure},
                {"velocity", "m/s", OutputField::Place::cells, mesh.dim, velocity}});
  MPI_Barrier(mesh.comm);  // rank 0 writes the index last; all may read it from here on
}

std::string index_of(const support::SharedFolder& scratch) {
  std::ifstream in(scratch / "fluid.xdmf");
  return {std::istreambuf_iterator<char>(in), {}};
}

int count(const std::string& text, const std::string& word) {
  int n = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST(FieldWriter, every_cell_and_point_is_written_once_with_its_own_values) {
  const support::SharedFolder scratch;
  for (const BoxCells cells : {BoxCells::quadrilaterals, BoxCells::mixed}) {
    const auto [mesh, geometry] = make_mesh(cells);
    FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, nan_time);
    write(writer, mesh, geometry, 0.5);
    const hdf5::Reader file(scratch / "fluid.h5", "output");
    const std::uint64_t n = file.rows("mesh/cell-id", 1), np = file.rows("mesh/point-id", 1);
    EXPECT_EQ(n, std::uint64_t(mesh.cells.n_global()));
    EXPECT_EQ(np, std::uint64_t(mesh.points.n_global()));
    std::vector<std::int64_t> cell_id(n), point_id(np);
    std::vector<double> pressure(n), velocity(3 * n);
    file.read("mesh/cell-id", {0, n, n, 1}, cell_id.data());
    file.read("mesh/point-id", {0, np, np, 1}, point_id.data());
    file.read("steps/000000/cells/pressure", {0, n, n, 1}, pressure.data());
    file.read("steps/000000/cells/velocity", {0, n, n, 3}, velocity.data());
    for (std::uint64_t c = 0; c < n; ++c) {
      EXPECT_EQ(pressure[c], double(cell_id[c]) + 0.5);
      EXPECT_EQ(velocity[3 * c + 1], double(10 * cell_id[c] + 1));
      EXPECT_EQ(velocity[3 * c + 2], mesh.dim == 2 ? 0.0 : double(10 * cell_id[c] + 2));
    }
    std::sort(cell_id.begin(), cell_id.end());
    std::sort(point_id.begin(), point_id.end());
    for (std::uint64_t c = 0; c < n; ++c) EXPECT_EQ(cell_id[c], std::int64_t(c));
    for (std::uint64_t p = 0; p < np; ++p) EXPECT_EQ(point_id[p], std::int64_t(p));
  }
}

TEST(FieldWriter, the_index_lists_each_time_after_it_was_written) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = make_mesh(BoxCells::triangles);
  FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, nan_time);
  for (int i = 0; i < 3; ++i) {
    write(writer, mesh, geometry, 0.25 * i);
    MPI_Barrier(world);
    const std::string index = index_of(scratch);
    EXPECT_EQ(count(index, "<Time "), i + 1);
    EXPECT_THAT(index, HasSubstr(fmt::format("<Time Value=\"{}\"/>", 0.25 * i)));
    EXPECT_EQ(count(index, "Name=\"velocity [m/s]\" AttributeType=\"Vector\" Center=\"Cell\""), i + 1);
    MPI_Barrier(world);
  }
}

TEST(FieldWriter, a_fixed_mesh_writes_its_points_once) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = make_mesh(BoxCells::quadrilaterals);
  FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", false, nan_time);
  write(writer, mesh, geometry, 0);
  const hdf5::Reader file(scratch / "fluid.h5", "output");
  EXPECT_FALSE(file.has("steps/000000/coordinates"));
  EXPECT_EQ(count(index_of(scratch), "fluid.h5:/mesh/coordinates"), 1);
}

TEST(FieldWriter, a_restart_drops_the_later_times_and_goes_on) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = make_mesh(BoxCells::quadrilaterals);
  {
    FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, nan_time);
    for (int i = 0; i < 5; ++i) write(writer, mesh, geometry, 0.25 * i);
  }
  FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, 0.5);
  MPI_Barrier(world);
  EXPECT_EQ(count(index_of(scratch), "<Time "), 3);
  MPI_Barrier(world);
  write(writer, mesh, geometry, 0.6);
  MPI_Barrier(world);
  EXPECT_EQ(count(index_of(scratch), "<Time "), 4);
  const hdf5::Reader file(scratch / "fluid.h5", "output");
  EXPECT_EQ(file.members("steps").size(), 4u);
  EXPECT_EQ(file.number("steps/000003", "time"), 0.6);
}

// What other ranks have begun goes on in their order: the reader sees one series on one mesh.
TEST(FieldWriter, a_series_goes_on_on_another_number_of_ranks) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = make_mesh(BoxCells::quadrilaterals);
  {
    FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, nan_time);
    write(writer, mesh, geometry, 0);
  }
  if (parallel::comm_rank(world) == 0) {
    const auto [alone, places] = make_mesh(BoxCells::quadrilaterals, 4, MPI_COMM_SELF);
    FieldWriter writer(alone, places.points, scratch / "", "fluid", true, 0);
    write(writer, alone, places, 0.5);
  }
  MPI_Barrier(world);
  {
    FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, 0.5);
    write(writer, mesh, geometry, 1);
  }
  const hdf5::Reader file(scratch / "fluid.h5", "output");
  const std::uint64_t n = file.rows("mesh/cell-id", 1), np = file.rows("mesh/point-id", 1);
  std::vector<std::int64_t> id(n);
  std::vector<double> pressure(n), start(3 * np), now(3 * np);
  file.read("mesh/cell-id", {0, n, n, 1}, id.data());
  file.read("mesh/coordinates", {0, np, np, 3}, start.data());
  for (int i = 0; i < 3; ++i) {
    const std::string step = fmt::format("steps/{:06d}", i);
    file.read(step + "/cells/pressure", {0, n, n, 1}, pressure.data());
    file.read(step + "/coordinates", {0, np, np, 3}, now.data());
    for (std::uint64_t c = 0; c < n; ++c) EXPECT_EQ(pressure[c], double(id[c]) + 0.5 * i);
    for (std::uint64_t p = 0; p < np; ++p) {
      EXPECT_EQ(now[3 * p], start[3 * p] + 0.5 * i * start[3 * p + 1]);
      EXPECT_EQ(now[3 * p + 1], start[3 * p + 1]);
    }
  }
  MPI_Barrier(world);
}

// Outputs of another mesh, a file whose end was never written, and what is no HDF5 file keep no run from resuming.
TEST(FieldWriter, sets_aside_a_file_that_cannot_be_continued) {
  for (const int cut : {0, 200, 1 << 20}) {
    const support::SharedFolder scratch;
    const auto [mesh, geometry] = make_mesh(BoxCells::quadrilaterals, cut == 0 ? 5 : 4);
    {
      const auto [first, places] = make_mesh(BoxCells::quadrilaterals);
      FieldWriter writer(first, places.points, scratch / "", "fluid", true, nan_time);
      write(writer, first, places, 0.25);
    }
    const auto size = std::filesystem::file_size(scratch / "fluid.h5");
    MPI_Barrier(world);
    if (parallel::comm_rank(world) == 0)
      std::filesystem::resize_file(scratch / "fluid.h5", size - std::min<std::uintmax_t>(cut, size));
    MPI_Barrier(world);
    FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, 0.5);
    write(writer, mesh, geometry, 0.75);
    EXPECT_TRUE(std::filesystem::exists(scratch / "fluid.h5.aside")) << cut;
    const hdf5::Reader file(scratch / "fluid.h5", "output");
    EXPECT_EQ(file.members("steps").size(), 1u) << cut;
    EXPECT_EQ(file.number("steps/000000", "time"), 0.75) << cut;
    MPI_Barrier(world);
  }
}

TEST(FieldWriter, a_field_of_the_wrong_size_is_refused) {
  const support::SharedFolder scratch;
  const auto [mesh, geometry] = make_mesh(BoxCells::quadrilaterals);
  FieldWriter writer(mesh, geometry.points, scratch / "", "fluid", true, nan_time);
  const std::vector<double> values(1);
  EXPECT_THAT(support::error_of([&] {
                writer.write(0, geometry.points, {{"p", "Pa", OutputField::Place::points, 3, values}});
              }),
              HasSubstr("The output field 'p' has only 1 values"));
}

}  // namespace couplet::field_writer_test
