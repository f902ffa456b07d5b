// SPDX-License-Identifier: Apache-2.0
#include "common/io/cut_mesh.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/entries.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"

namespace couplet::cut_mesh_test {

namespace fs = std::filesystem;

class CutMesh : public ::testing::Test {
 protected:
  const support::SharedFolder folder;
  const fs::path file = folder / "box.h5";
  mesh::RawMesh raw = [] {
    mesh::RawMesh box = mesh::make_box(mesh::BoxCells::mixed, {4, 5, 3}, Vec3::Zero(), Vec3(4, 5, 3));
    mesh::perturb_interior(box, 0.2, 7);
    return box;
  }();
  void SetUp() override {
    io::write_cut_mesh(MPI_COMM_WORLD,
                       mesh::block_of(MPI_COMM_WORLD, raw, parallel::comm_size(MPI_COMM_WORLD)), file);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::string error_of_opening() const {
    MPI_Barrier(MPI_COMM_WORLD);
    return support::error_of([&] { io::load_mesh(MPI_COMM_WORLD, file, 3); });
  }
  template <class Change>
  void on_first_rank(Change&& change) const {
    if (parallel::comm_rank(MPI_COMM_WORLD) == 0) change();
    MPI_Barrier(MPI_COMM_WORLD);
  }
};

TEST_F(CutMesh, gives_each_rank_the_block_that_was_written) {
  const mesh::MeshBlock written = mesh::block_of(MPI_COMM_WORLD, raw, parallel::comm_size(MPI_COMM_WORLD)),
                        read = io::read_cut_mesh(MPI_COMM_WORLD, file);
  EXPECT_EQ(read.points, written.points);
  EXPECT_EQ(read.cells.type, written.cells.type);
  EXPECT_EQ(read.cells.points, written.cells.points);
  EXPECT_EQ(read.cells.zone, written.cells.zone);
  EXPECT_EQ(read.element_points, written.element_points);
  EXPECT_EQ(read.element_patch, written.element_patch);
  EXPECT_EQ(read.patches, written.patches);
  EXPECT_EQ(read.zones, written.zones);
}

TEST_F(CutMesh, is_the_same_mesh_as_the_one_it_was_cut_from_on_any_ranks) {
  const mesh::LoadedMesh whole = mesh::distribute(MPI_COMM_SELF, raw),
                         here = io::load_mesh(MPI_COMM_WORLD, file, 3),
                         alone = io::load_mesh(MPI_COMM_SELF, file, 3);
  EXPECT_EQ(mesh::identity_of(here.mesh), mesh::identity_of(whole.mesh));
  EXPECT_EQ(alone.mesh.cell_id, whole.mesh.cell_id);
  EXPECT_EQ(alone.geometry.volume, whole.geometry.volume);
  EXPECT_EQ(alone.geometry.face_area, whole.geometry.face_area);
}

TEST_F(CutMesh, that_is_truncated_is_refused_by_name) {
  on_first_rank([&] { fs::resize_file(file, fs::file_size(file) / 2); });
  EXPECT_THAT(error_of_opening(),
              ::testing::AllOf(::testing::HasSubstr(file.string()), ::testing::HasSubstr("truncated")));
}

TEST_F(CutMesh, of_another_version_is_refused) {
  on_first_rank([&] {
    io::hdf5::Handle out = io::hdf5::create_file(MPI_COMM_SELF, file);
    io::hdf5::write_attribute(out, "cut-mesh-version", 2);
    io::hdf5::close_file(MPI_COMM_SELF, out, file);
  });
  EXPECT_THAT(error_of_opening(), ::testing::HasSubstr("it is of version 2; this program reads version 1"));
}

TEST_F(CutMesh, with_one_coordinate_changed_is_refused) {
  on_first_rank([&] {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    std::string text(fs::file_size(file), '\0');
    bytes.read(text.data(), std::streamsize(text.size()));
    const double x = raw.points[37][1];
    const std::size_t at = text.find(std::string(reinterpret_cast<const char*>(&x), sizeof x));
    ASSERT_NE(at, std::string::npos);
    bytes.seekp(std::streamoff(at));
    bytes.put(char(text[at] ^ 1));
  });
  EXPECT_THAT(error_of_opening(), ::testing::HasSubstr("the table 'points' is damaged: its digest differs"));
}

}  // namespace couplet::cut_mesh_test
