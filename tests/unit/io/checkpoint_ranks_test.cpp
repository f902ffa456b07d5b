// SPDX-License-Identifier: Apache-2.0
// Fields of a mesh by the numbers of their entries: on any ranks the same file, and back from it on any other ones.
#include "common/io/checkpoint.hpp"
#include "common/mesh/load.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::checkpoint_ranks_test {
using namespace io;

using mesh::Entries;
using ::testing::HasSubstr;

mesh::LoadedMesh box(MPI_Comm comm, mesh::BoxCells cells, std::array<int, 3> n = {5, 4, 3}) {
  return mesh::distribute(comm, mesh::make_box(cells, n, Vec3::Zero(), Vec3(5, 4, 3)));
}

/// A value that only the place tells.
double value_at(const Vec3& x) { return std::sin(1 + x.x() + 7.3 * x.y() + 31.7 * x.z()); }

std::vector<double> values_of(const mesh::LoadedMesh& loaded, Entries entries) {
  const auto& [mesh, g] = loaded;
  const std::size_t n = mesh::OrderOfEntries(mesh).of(entries).n_local();
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const bool of_boundary = entries == Entries::boundary || entries == Entries::owned_boundary;
    const Vec3 x = entries == Entries::points ? g.points[i]
                   : entries == Entries::cells || entries == Entries::owned_cells
                       ? g.cell_centre[i]
                       : g.face_centre[i + (of_boundary ? std::size_t(mesh.n_interior) : 0)];
    values.insert(values.end(), {value_at(x), -value_at(x)});
  }
  return values;
}

const std::vector<std::pair<Entries, std::string>> all_entries{
    {Entries::cells, "cells"},          {Entries::owned_cells, "owned-cells"},
    {Entries::points, "points"},        {Entries::boundary, "boundary"},
    {Entries::owned_boundary, "walls"}, {Entries::interior_faces, "interior"},
    {Entries::flux_faces, "flux"}};

void write_all(MPI_Comm comm, const mesh::LoadedMesh& loaded, const std::filesystem::path& file) {
  CheckpointWriter writer(comm, file);
  writer.on(loaded.mesh);
  for (const auto& [entries, name] : all_entries) writer.write(entries, name, values_of(loaded, entries));
  writer.write_common("numbers", std::vector<double>{1, 2, 3});
  writer.write_sums("sums", std::vector<double>{0.5 + parallel::comm_rank(comm)});
  writer.close();
}

void expect_all(MPI_Comm comm, const mesh::LoadedMesh& loaded, const std::filesystem::path& file) {
  CheckpointReader reader(comm, file);
  reader.on(loaded.mesh);
  for (const auto& [entries, name] : all_entries) {
    const std::vector<double> right = values_of(loaded, entries);
    std::vector<double> values(right.size());
    reader.read(entries, name, values);
    EXPECT_EQ(values, right) << name;
  }
  EXPECT_EQ(reader.read_common("numbers"), (std::vector<double>{1, 2, 3}));
}

// One rank alone reads what all have written, and all read what one has.
TEST(CheckpointRanks, fields_of_every_kind_come_back_on_another_number_of_ranks) {
  const support::SharedFolder scratch;
  for (const auto cells :
       {mesh::BoxCells::hexahedra, mesh::BoxCells::tetrahedra, mesh::BoxCells::quadrilaterals}) {
    const auto all = box(world, cells);
    write_all(world, all, scratch / "all.h5");
    expect_all(world, all, scratch / "all.h5");
    if (parallel::comm_rank(world) == 0) {
      const auto one = box(MPI_COMM_SELF, cells);
      expect_all(MPI_COMM_SELF, one, scratch / "all.h5");
      write_all(MPI_COMM_SELF, one, scratch / "one.h5");
    }
    MPI_Barrier(world);
    expect_all(world, all, scratch / "one.h5");
  }
}

TEST(CheckpointRanks, copies_that_differ_from_their_owners_come_back_bit_for_bit_on_equal_ranks) {
  const support::SharedFolder scratch;
  const auto loaded = box(world, mesh::BoxCells::hexahedra);
  std::vector<double> values = values_of(loaded, Entries::flux_faces);
  for (double& v : values) v += 1e-16 * parallel::comm_rank(world);
  CheckpointWriter writer(world, scratch / "a.h5");
  writer.on(loaded.mesh);
  writer.write(Entries::flux_faces, "flux", values);
  writer.close();
  CheckpointReader reader(world, scratch / "a.h5");
  reader.on(loaded.mesh);
  EXPECT_TRUE(reader.on_same_ranks());
  EXPECT_EQ(reader.read(Entries::flux_faces, "flux"), values);
}

TEST(CheckpointRanks, sums_are_kept_by_each_rank_or_gathered_on_the_first) {
  const support::SharedFolder scratch;
  const auto loaded = box(world, mesh::BoxCells::hexahedra);
  write_all(world, loaded, scratch / "a.h5");
  const int size = parallel::comm_size(world), rank = parallel::comm_rank(world);
  std::vector<double> sum(1);
  CheckpointReader(world, scratch / "a.h5").read_sums("sums", sum);
  EXPECT_EQ(sum[0], 0.5 + rank);
  if (rank == 0 && size > 1) {
    CheckpointReader(MPI_COMM_SELF, scratch / "a.h5").read_sums("sums", sum);
    EXPECT_EQ(sum[0], 0.5 * size + 0.5 * size * (size - 1));
  }
  MPI_Barrier(world);
}

TEST(CheckpointRanks, another_mesh_is_refused_with_file_and_cause) {
  const support::SharedFolder scratch;
  const auto one = box(world, mesh::BoxCells::hexahedra),
             other = box(world, mesh::BoxCells::hexahedra, {4, 5, 3});
  write_all(world, one, scratch / "a.h5");
  EXPECT_THAT(support::error_of([&] { CheckpointReader(world, scratch / "a.h5").on(other.mesh); }),
              ::testing::AllOf(HasSubstr("a.h5' is from another mesh, of 60 cells, 120 points"),
                               HasSubstr("in a different order")));
}

// An order of distributed entries that is none is refused on all ranks; a guest's numbers may be wrong.
TEST(CheckpointRanks, numbers_that_are_not_unique_make_no_order) {
  const std::vector<GlobalIndex> twice{3, 3};
  EXPECT_THROW(parallel::GlobalOrder(world, twice, 2), Error);
  const auto order = parallel::GlobalOrder::by_numbers(world, twice, 2);
  EXPECT_EQ(order.n_global(), 2 * parallel::comm_size(world));
  const std::vector<double> values{1. + parallel::comm_rank(world), 2};
  EXPECT_EQ(order.from_block(order.to_block(values, 1), 1), values);
}

}  // namespace couplet::checkpoint_ranks_test
