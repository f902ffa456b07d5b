// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/io/numbering.hpp"
#include "common/mesh/load.hpp"

namespace couplet {
using namespace io;
namespace {

mesh::LoadedMesh box() {
  return mesh::distribute(
      MPI_COMM_WORLD, mesh::make_box(mesh::BoxCells::quadrilaterals, {6, 5, 1}, Vec3::Zero(), Vec3(6, 5, 0)));
}

TEST(Numbering, a_mesh_shared_out_as_before_is_taken) {
  const auto [mesh, geometry] = box();
  StateInMemory memory;
  CheckpointWriter writer(memory);
  write_numbering(writer, mesh);
  CheckpointReader reader(memory);
  EXPECT_NO_THROW(check_numbering(reader, mesh));
}

// The same counts: only the order tells. One rank alone sees the difference, all must refuse.
TEST(Numbering, the_same_cells_in_another_order_are_refused_on_all_ranks) {
  auto [mesh, geometry] = box();
  StateInMemory memory;
  CheckpointWriter writer(memory);
  write_numbering(writer, mesh);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0) std::swap(mesh.cell_id[0], mesh.cell_id[1]);
  CheckpointReader reader(memory);
  EXPECT_THROW(check_numbering(reader, mesh), Error);
}

}  // namespace
}  // namespace couplet
