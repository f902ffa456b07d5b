// SPDX-License-Identifier: Apache-2.0
#include <bit>

#include "common/io/checkpoint.hpp"
#include "common/io/hdf5.hpp"
#include "tests/support/shared_folder.hpp"
#include "tests/support/test.hpp"
#include "tests/support/world.hpp"

namespace couplet::checkpoint_test {
using namespace io;

using ::testing::HasSubstr;

// Another count on every rank (none on the last of three), with values that printing would spoil.
std::vector<double> awkward_values() {
  const int rank = parallel::comm_rank(world);
  std::mt19937_64 random(42 + rank);
  std::vector<double> values(rank == 2 ? 0 : 1000 + 17 * rank);
  for (double& v : values) v = std::ldexp(double(random()) / 3, int(random() % 200) - 100);
  if (values.size() > 4) {
    values[0] = -0.0;
    values[1] = std::numeric_limits<double>::quiet_NaN();
    values[2] = std::numeric_limits<double>::denorm_min();
    values[3] = std::numeric_limits<double>::infinity();
  }
  return values;
}

void write_one(const std::filesystem::path& file, const std::vector<double>& values, double time = 1.25) {
  CheckpointWriter writer(world, file);
  writer.write("solid/displacement", values);
  writer.write_common("time", std::array<double, 1>{time});
  writer.close();
}

// Changes the file as a crash or a bad disk would, seen by all ranks.
template <class Action>
void damage(const std::filesystem::path& file, Action&& action) {
  if (parallel::comm_rank(world) == 0) action(file);
  MPI_Barrier(world);
}

/// NaN and signed zeros included. Not memcmp: a rank may have nothing, and a null pointer is not allowed there.
bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint64_t, double>,
                            std::bit_cast<std::uint64_t, double>);
}

TEST(Checkpoint, comes_back_bit_for_bit) {
  const support::SharedFolder scratch;
  const std::vector<double> values = awkward_values();
  write_one(scratch / "a.h5", values, 0.1 + 0.2);
  CheckpointReader reader(world, scratch / "a.h5");
  const std::vector<double> back = reader.read("solid/displacement");
  ASSERT_EQ(back.size(), values.size());
  EXPECT_TRUE(same_bits(back, values));
  std::vector<double> filled(values.size());
  reader.read("solid/displacement", filled);
  EXPECT_TRUE(same_bits(filled, values));
  EXPECT_EQ(reader.read_common("time").front(), 0.1 + 0.2);
}

TEST(Checkpoint, an_array_that_is_empty_everywhere_comes_back_empty) {
  const support::SharedFolder scratch;
  write_one(scratch / "a.h5", {});
  CheckpointReader reader(world, scratch / "a.h5");
  EXPECT_TRUE(reader.read("solid/displacement").empty());
}

TEST(Checkpoint, the_last_good_file_stays_until_the_new_one_is_closed) {
  const support::SharedFolder scratch;
  const auto file = scratch / "a.h5";
  write_one(file, {1.0}, 1);
  {
    CheckpointWriter abandoned(world, file);
    abandoned.write_common("time", std::array<double, 1>{2});
    EXPECT_EQ(CheckpointReader(world, file).read_common("time").front(), 1);
  }
  EXPECT_EQ(CheckpointReader(world, file).read_common("time").front(), 1);
  EXPECT_FALSE(std::filesystem::exists(file.string() + ".part"));
  write_one(file, {1.0}, 3);
  EXPECT_EQ(CheckpointReader(world, file).read_common("time").front(), 3);
}

TEST(Checkpoint, a_missing_file_is_named_on_every_rank) {
  const support::SharedFolder scratch;
  EXPECT_THAT(support::error_of([&] { CheckpointReader(world, scratch / "b.h5"); }),
              HasSubstr("does not exist."));
}

TEST(Checkpoint, a_truncated_file_is_refused_on_every_rank) {
  const support::SharedFolder scratch;
  const auto file = scratch / "a.h5";
  write_one(file, awkward_values());
  const auto size = std::filesystem::file_size(file);
  for (const double part : {0.9, 0.5, 0.2}) {
    damage(file,
           [&](const auto& f) { std::filesystem::resize_file(f, std::uintmax_t(part * double(size))); });
    EXPECT_THAT(support::error_of([&] { CheckpointReader(world, file); }),
                ::testing::AllOf(HasSubstr(": it is not an HDF5 file, or its beginning is damaged"),
                                 HasSubstr("(truncated file:")))
        << part;
  }
  damage(file, [](const auto& f) { std::filesystem::resize_file(f, 0); });
  EXPECT_THAT(support::error_of([&] { CheckpointReader(world, file); }), HasSubstr("it is not an HDF5 file"));
}

TEST(Checkpoint, other_files_are_not_taken_for_checkpoints) {
  const support::SharedFolder scratch;
  const auto file = scratch / "a.h5";
  damage(file, [](const auto& f) { std::ofstream(f) << "hello"; });
  EXPECT_THAT(support::error_of([&] { CheckpointReader(world, file); }), HasSubstr("it is not an HDF5 file"));
}

TEST(Checkpoint, an_earlier_version_is_refused_with_file_and_both_versions) {
  const support::SharedFolder scratch;
  write_one(scratch / "old.h5", awkward_values());
  damage(scratch / "old.h5", [](const std::filesystem::path& path) {
    const hdf5::Handle file = hdf5::open_file_to_write(MPI_COMM_SELF, path);
    const hdf5::Handle version(H5Aopen(file, "version", H5P_DEFAULT), H5Aclose);
    const double before = 4;
    ASSERT_GE(H5Awrite(version, H5T_NATIVE_DOUBLE, &before), 0);
  });
  EXPECT_THAT(support::error_of([&] { CheckpointReader(world, scratch / "old.h5"); }),
              ::testing::AllOf(HasSubstr("old.h5' has format version 4; this program reads version 16"),
                               HasSubstr("with the release that wrote it")));
  EXPECT_THAT(problem_of_checkpoint(scratch / "old.h5"), HasSubstr("format version 4"));
}

TEST(Checkpoint, values_that_are_each_ranks_own_are_refused_on_another_number_of_ranks_with_both_numbers) {
  const support::SharedFolder scratch;
  const auto file = scratch / "a.h5";
  write_one(file, awkward_values());
  const int size = parallel::comm_size(world);
  if (parallel::comm_rank(world) == 0 && size > 1) {
    CheckpointReader reader(MPI_COMM_SELF, file);
    EXPECT_EQ(reader.read_common("time").front(), 1.25);
    EXPECT_THAT(support::error_of([&] { reader.read("solid/displacement"); }),
                HasSubstr(fmt::format("was written on {} ranks, but this run has 1", size)));
  }
  MPI_Barrier(world);
}

TEST(Checkpoint, a_missing_name_or_another_size_is_told_on_every_rank) {
  const support::SharedFolder scratch;
  write_one(scratch / "a.h5", awkward_values());
  CheckpointReader reader(world, scratch / "a.h5");
  EXPECT_THAT(support::error_of([&] { reader.read("fluid/velocity"); }),
              HasSubstr("has no array 'fluid/velocity'"));
  EXPECT_THAT(support::error_of([&] { reader.read_common("dt"); }), HasSubstr("has no array 'dt'"));
  // Only rank 0 asks for a wrong size: all must hear of it.
  std::vector<double> values(awkward_values().size() + (parallel::comm_rank(world) == 0 ? 1 : 0));
  EXPECT_THAT(support::error_of([&] { reader.read("solid/displacement", values); }),
              HasSubstr("has 1000 values of 'solid/displacement' on rank 0, but 1001 are expected"));
  EXPECT_EQ(reader.read_common("time").front(), 1.25);
}

TEST(Checkpoint, a_folder_that_cannot_be_made_is_named) {
  const support::SharedFolder scratch;
  damage(scratch / "file", [](const auto& f) { std::ofstream(f) << "in the way"; });
  EXPECT_THAT(support::error_of([&] { CheckpointWriter(world, scratch / "file" / "a.h5"); }),
              HasSubstr("Cannot create"));
}

}  // namespace couplet::checkpoint_test
