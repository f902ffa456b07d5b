// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"

namespace couplet::io {
namespace {

constexpr const char* what = "checkpoint";
constexpr const char* advice = "Use an earlier one.";
constexpr std::int64_t most_wide = 1 << 20;  // values per entry

/// Whether the stamp in the file is that of the set it lies in.
void examine_stamp(const hdf5::Reader& in) {
  const auto set = read_checkpoint_set(folder_of(in.file()));
  if (!set || in.text("/", "set", 1024) == set->stamp.text()) return;
  throw Error(
      "'{}' is from another step or another run than the checkpoint that contains it (step {}, t = {:g} s "
      "of run {}).",
      in.file().string(), set->stamp.step, set->stamp.time, set->stamp.run);
}

/// All of the file but the values, which HDF5 copies as they are.
void examine_content(const hdf5::Reader& in) {
  if (!in.has_attribute("/", "format") || in.text("/", "format") != checkpoint_format)
    throw Error("'{}' is an HDF5 file, but not a checkpoint.", in.file().string());
  if (const double version = in.number("/", "version"); version != checkpoint_version)
    throw Error(
        "The checkpoint '{}' has format version {}; this program reads version {}. Continue it with the "
        "release that wrote it, or start again.",
        in.file().string(), version, checkpoint_version);
  const int ranks = ranks_that_wrote(in);
  examine_stamp(in);
  for (const std::string& name : in.leaves("arrays")) layout_of_array(in, name, ranks);
  for (const std::string& name : in.leaves("fields")) check_of_field(in, name);
  for (const std::string& name : in.leaves("scalars")) scalar_on_file(in, name);
}

}  // namespace

hdf5::Reader open_checkpoint(const std::filesystem::path& file) { return {file, what, advice}; }

std::vector<std::int64_t> layout_of_array(const hdf5::Reader& in, const std::string& name, int ranks) {
  const auto n = std::uint64_t(ranks);
  if (const std::uint64_t rows = in.rows(layout_path(name), 2); rows != n)
    in.refuse(fmt::format("the layout of '{}' is for {} ranks; expected {}", name, rows, n));
  std::vector<std::int64_t> layout(2 * n);
  in.read(layout_path(name), {0, n, n, 2}, layout.data());
  const std::uint64_t total = in.rows(array_path(name), 1);
  std::uint64_t left = total;
  for (std::size_t r = 0; r < n; ++r) {
    if (layout[2 * r] < 0 || std::uint64_t(layout[2 * r]) > left)
      in.refuse(
          fmt::format("the array '{}' has {} values; its layout assigns to rank {} {} of the {} "
                      "remaining",
                      name, total, r, layout[2 * r], left));
    left -= std::uint64_t(layout[2 * r]);
  }
  if (left != 0)
    in.refuse(fmt::format("the array '{}' has {} values; its layout assigns {} of them to no rank", name,
                          total, left));
  return layout;
}

FieldCheck check_of_field(const hdf5::Reader& in, const std::string& name) {
  std::array<std::int64_t, 3> check{};
  in.read(check_path(name), {0, 1, 1, 3}, check.data());
  const auto [rows, width, sum] = check;
  if (rows < 0 || width < 0 || width > most_wide || (rows == 0) != (width == 0))
    in.refuse(fmt::format("the field '{}' claims {} rows of {} values", name, rows, width));
  const std::uint64_t found = in.rows(field_path(name), std::uint64_t(std::max<std::int64_t>(width, 1)));
  if (found != std::uint64_t(rows))
    in.refuse(fmt::format("the field '{}' has {} rows; expected {}", name, found, rows));
  return {std::uint64_t(rows), std::size_t(width), sum};
}

double scalar_on_file(const hdf5::Reader& in, const std::string& name) {
  double value = 0;
  in.read(scalar_path(name), {0, 1, 1, 1}, &value);
  return value;
}

int ranks_that_wrote(const hdf5::Reader& in) {
  const double written = in.number("/", "ranks");
  if (!(written >= 1 && written < 1e8) || written != std::floor(written))
    in.refuse(fmt::format("it was written on {} ranks", written));
  return int(written);
}

void examine_checkpoint(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw Error("The checkpoint '{}' does not exist.", file.string());
  if (const std::string problem = problem_in_set(file); !problem.empty()) throw Error(problem);
  examine_content(open_checkpoint(file));
}

std::string problem_of_checkpoint(const std::filesystem::path& file) {
  try {
    examine_checkpoint(file);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace couplet::io
