// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/readers/read_msh.hpp"

#include <iterator>

#include "tests/unit/mesh/support.hpp"

namespace couplet::msh_block_test {
using namespace mesh;
using namespace parallel;

using ::testing::HasSubstr;

/// One file for all ranks, written by rank 0.
class MshBlocks : public ::testing::Test {
 protected:
  MshBlocks() {
    std::string name = own_.path.string();
    broadcast(MPI_COMM_WORLD, name);
    folder_ = name;
  }
  ~MshBlocks() override { MPI_Barrier(MPI_COMM_WORLD); }
  std::filesystem::path write(const std::string& text) {
    if (comm_rank(MPI_COMM_WORLD) == 0) std::ofstream(folder_ / "mesh.msh", std::ios::binary) << text;
    MPI_Barrier(MPI_COMM_WORLD);
    return folder_ / "mesh.msh";
  }

 private:
  test::TemporaryFolder own_;
  std::filesystem::path folder_;
};

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void expect_as_whole(const std::filesystem::path& file) {
  SCOPED_TRACE(file.string());
  const MeshBlock read = read_msh_block(MPI_COMM_WORLD, file, comm_size(MPI_COMM_WORLD));
  const MeshBlock cut = block_of(MPI_COMM_WORLD, read_msh(file), comm_size(MPI_COMM_WORLD));
  EXPECT_EQ(read.dim, cut.dim);
  EXPECT_EQ(read.points, cut.points);
  EXPECT_EQ(read.point_shares.n, cut.point_shares.n);
  EXPECT_EQ(read.cell_shares.n, cut.cell_shares.n);
  EXPECT_EQ(read.cells.type, cut.cells.type);
  EXPECT_EQ(read.cells.points, cut.cells.points);
  EXPECT_EQ(read.cells.point_offset, cut.cells.point_offset);
  EXPECT_EQ(read.cells.zone, cut.cells.zone);
  EXPECT_EQ(read.element_points, cut.element_points);
  EXPECT_EQ(read.element_offset, cut.element_offset);
  EXPECT_EQ(read.element_patch, cut.element_patch);
  EXPECT_EQ(read.zones, cut.zones);
  EXPECT_EQ(read.patches, cut.patches);
}

TEST_F(MshBlocks, are_those_of_the_whole_mesh) {
  for (const std::string name : {"plane_", "solid_"})
    for (const char* kind : {"22_ascii", "22_binary", "41_ascii", "41_binary"})
      expect_as_whole(test::data / (name + kind + ".msh"));
}

// Nodes 8, 7, then 1 to 3 and 5; 7 belongs to nothing. The line along the bottom is in two groups.
const std::string drawn =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n3\n1 4 \"bottom\"\n1 5 \"rest\"\n2 9 \"all of it\"\n$EndPhysicalNames\n"
    "$Entities\n0 2 1 0\n1 0 0 0 1 0 0 2 4 5 0\n2 0 0 0 1 1 0 1 -5 0\n1 0 0 0 1 1 0 1 9 0\n$EndEntities\n"
    "$Nodes\n2 6 1 8\n2 1 0 2\n8\n7\n0 1 0\n5 5 0\n2 1 0 4\n1\n2\n3\n5\n0 0 0\n1 0 0\n1 1 0\n0.5 0.5 0\n$EndNodes\n"
    "$Elements\n3 8 1 8\n1 1 1 1\n1 1 2\n1 2 1 3\n2 2 3\n3 3 8\n4 8 1\n2 1 2 4\n5 1 2 5\n6 2 3 5\n7 3 8 5\n8 8 1 5\n"
    "$EndElements\n";

TEST_F(MshBlocks, with_scattered_numbers_and_points_that_nothing_has) { expect_as_whole(write(drawn)); }

TEST_F(MshBlocks, of_a_damaged_file_are_refused_on_all_ranks_in_the_same_words) {
  const auto error = [](const std::filesystem::path& file) {
    return support::error_of([&] { read_msh_block(MPI_COMM_WORLD, file, comm_size(MPI_COMM_WORLD)); });
  };
  for (const char* name : {"solid_41_ascii.msh", "solid_41_binary.msh", "solid_22_binary.msh"}) {
    const std::string text = text_of(test::data / name);
    for (const std::size_t cut : {text.size() / 2, std::size_t(40)})
      EXPECT_THAT(error(write(text.substr(0, text.size() - cut))), HasSubstr("incomplete")) << name;
  }
  std::string unknown = drawn;
  unknown.replace(unknown.find("8 8 1 5\n"), 8, "8 8 1 6\n");
  EXPECT_THAT(error(write(unknown)), HasSubstr(":45: An element uses node 6, which is not in $Nodes."));
  std::string twice = drawn;
  twice.replace(twice.find("\n7\n0 1 0"), 3, "\n5\n");
  EXPECT_THAT(error(write(twice)), HasSubstr("Duplicate node 5."));
}

}  // namespace couplet::msh_block_test
