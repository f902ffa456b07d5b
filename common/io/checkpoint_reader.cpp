// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_format.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/hdf5.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

namespace {

constexpr const char* what = "checkpoint";
constexpr const char* advice = "Use an earlier one.";
constexpr std::int64_t most_wide = 1 << 20;  // values per entry

hdf5::Reader open_checkpoint(const std::filesystem::path& file) { return {file, what, advice}; }

/// Number of values that each rank wrote, from rank 0 on.
std::vector<std::int64_t> layout_of_array(const hdf5::Reader& in, const std::string& name, int ranks) {
  const auto n = std::uint64_t(ranks);
  if (const std::uint64_t rows = in.rows(layout_path(name), 1); rows != n)
    in.refuse(fmt::format("the layout of '{}' is for {} ranks; expected {}", name, rows, n));
  std::vector<std::int64_t> layout(n);
  in.read(layout_path(name), {0, n, n, 1}, layout.data());
  const std::uint64_t total = in.rows(array_path(name), 1);
  std::uint64_t left = total;
  for (std::size_t r = 0; r < n; ++r) {
    if (layout[r] < 0 || std::uint64_t(layout[r]) > left)
      in.refuse(
          fmt::format("the array '{}' has {} values; its layout assigns to rank {} {} of the {} remaining",
                      name, total, r, layout[r], left));
    left -= std::uint64_t(layout[r]);
  }
  if (left != 0)
    in.refuse(fmt::format("the array '{}' has {} values; its layout assigns {} of them to no rank", name,
                          total, left));
  return layout;
}

struct FieldCheck {
  std::uint64_t rows = 0;
  std::size_t width = 0;
};
FieldCheck check_of_field(const hdf5::Reader& in, const std::string& name) {
  std::array<std::int64_t, 2> check{};
  in.read(check_path(name), {0, 1, 1, 2}, check.data());
  const auto [rows, width] = check;
  if (rows < 0 || width < 0 || width > most_wide || (rows == 0) != (width == 0))
    in.refuse(fmt::format("the field '{}' claims {} rows of {} values", name, rows, width));
  const std::uint64_t found = in.rows(field_path(name), std::uint64_t(std::max<std::int64_t>(width, 1)));
  if (found != std::uint64_t(rows))
    in.refuse(fmt::format("the field '{}' has {} rows; expected {}", name, found, rows));
  return {std::uint64_t(rows), std::size_t(width)};
}

int ranks_that_wrote(const hdf5::Reader& in) {
  const double written = in.number("/", "ranks");
  if (!(written >= 1 && written < 1e8) || written != std::floor(written))
    in.refuse(fmt::format("it was written on {} ranks", written));
  return int(written);
}

/// Throws Error for a file with another stamp than its set.
void examine_stamp(const hdf5::Reader& in) {
  const auto set = read_checkpoint_set(folder_of(in.file()));
  if (!set || in.text("/", "set", 1024) == set->stamp.text()) return;
  throw Error(
      "'{}' is from another step or another run than the checkpoint that contains it (step {}, t = {:g} s of run {}).",
      in.file().string(), set->stamp.step, set->stamp.time, set->stamp.run);
}

/// Checks everything except the values, which HDF5 copies unchanged.
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
}

/// Throws Error for a damaged file. Compares its digest before HDF5 reads it.
void examine_checkpoint(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw Error("The checkpoint '{}' does not exist.", file.string());
  if (const std::string problem = problem_in_set(file); !problem.empty()) throw Error(problem);
  examine_content(open_checkpoint(file));
}

}  // namespace

std::string problem_of_checkpoint(const std::filesystem::path& file) {
  try {
    examine_checkpoint(file);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

struct CheckpointReader::ReaderState {
  MPI_Comm comm;
  hdf5::Reader in;
  int ranks = 0;            // that wrote it
  bool same_share = false;  // of the mesh, on all ranks; without a mesh: as many ranks
  std::optional<mesh::OrderOfEntries> orders{};

  [[noreturn]] void missing(const std::string& name) const {
    throw Error("The checkpoint '{}' has no array '{}'. It was written by another program or another case.",
                in.file().string(), name);
  }

  /// Reads the array of rank `from` on this rank.
  std::vector<double> array_of(const std::string& name, int from) const {
    return parallel::on_all(comm, [&] {
      if (!in.has(array_path(name)) || !in.has(layout_path(name))) missing(name);
      const std::vector<std::int64_t> layout = layout_of_array(in, name, ranks);
      hdf5::RowSpan rows;
      for (int r = 0; r < ranks; ++r) {
        if (r < from) rows.first += std::uint64_t(layout[r]);
        rows.total += std::uint64_t(layout[r]);
      }
      rows.count = std::uint64_t(layout[from]);
      std::vector<double> values(rows.count);
      in.read(array_path(name), rows, values.data());
      return values;
    });
  }

  std::vector<double> own_array(const std::string& name) const {
    const int size = parallel::comm_size(comm);
    if (ranks != size && in.has(array_path(name)))
      throw Error(
          "The checkpoint '{}' was written on {} {}, but this run has {}, and its array '{}' belongs to individual ranks. "
          "Restart on the same number of ranks.",
          in.file().string(), ranks, ranks == 1 ? "rank" : "ranks", size, name);
    return array_of(name, parallel::comm_rank(comm));
  }

  /// Restores values of a rank that differ from the owner's.
  void put_copies(const std::string& name, std::vector<double>& values) const {
    if (!same_share || ranks == 1 || !in.has(array_path(copies_of(name)))) return;
    const std::vector<double> copies = own_array(copies_of(name));
    parallel::on_all(comm, [&] {
      for (std::size_t i = 0; i + 1 < copies.size(); i += 2) {
        if (!(copies[i] >= 0 && copies[i] < double(values.size())))
          in.refuse(fmt::format("the field '{}' has a copy of value {}", name, copies[i]));
        values[std::size_t(copies[i])] = copies[i + 1];
      }
    });
  }

  std::vector<double> field(const parallel::GlobalOrder& order, const std::string& name) const {
    const FieldCheck check = parallel::on_all(comm, [&] {
      if (!in.has(field_path(name)) || !in.has(check_path(name))) missing(name);
      const FieldCheck found = check_of_field(in, name);
      if (found.rows > 0 && found.rows != std::uint64_t(order.n_global()))
        throw Error(
            "The checkpoint '{}' has '{}' of {} entries, but {} are expected. Is it from the same mesh?",
            in.file().string(), name, found.rows, order.n_global());
      return found;
    });
    if (check.rows == 0) return {};
    const auto first = std::uint64_t(order.first());
    const std::vector<double> block = parallel::on_all(comm, [&] {
      std::vector<double> rows(order.count() * check.width);
      if (!rows.empty())
        in.read(field_path(name), {first, order.count(), check.rows, check.width}, rows.data());
      return rows;
    });
    std::vector<double> values = order.from_block(block, check.width);
    put_copies(name, values);
    return values;
  }

  void require(const std::string& name, std::size_t found, std::size_t wanted) const {
    parallel::throw_together(
        comm, found == wanted
                  ? ""
                  : fmt::format("The checkpoint '{}' has {} values of '{}' on rank {}, but {} are expected. "
                                "Is it from the same mesh?",
                                in.file().string(), found, name, parallel::comm_rank(comm), wanted));
  }
};

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& file) {
  parallel::on_root(comm, [&] { examine_checkpoint(file); });
  parallel::on_all(comm, [&] {
    state_ = std::make_unique<ReaderState>(ReaderState{comm, open_checkpoint(file)});
    state_->ranks = ranks_that_wrote(state_->in);
    state_->same_share = state_->ranks == parallel::comm_size(comm);
  });
}

// Only this rank opened the file, so closing it is local.
CheckpointReader::~CheckpointReader() = default;

CheckpointReader::CheckpointReader(const StateInMemory& memory) : memory_(&memory) {}

MPI_Comm CheckpointReader::comm() const { return memory_ ? MPI_COMM_SELF : state_->comm; }

void CheckpointReader::on(const mesh::Mesh& mesh) {
  if (memory_) return;
  const auto now = mesh::identity_of(mesh);
  const auto share = std::bit_cast<std::int64_t>(mesh::share_of_rank(mesh));
  const bool same = parallel::on_all(state_->comm, [&] {
    const hdf5::Reader& in = state_->in;
    auto then = now;
    if (!in.has(mesh_table))
      in.refuse("it contains no mesh: it was written by another program or another case");
    in.read(mesh_table, {0, 1, 1, then.size()}, then.data());
    if (then != now)
      throw Error(
          "The checkpoint '{}' is from another mesh, of {} cells, {} points and {} boundary faces; this one has {}, {} and "
          "{}{}. Another version of gmsh may number them differently; give the same mesh file.",
          in.file().string(), then[0], then[1], then[2], now[0], now[1], now[2],
          std::equal(then.begin(), then.begin() + 3, now.begin()) ? ", in a different order" : "");
    if (!state_->same_share) return false;
    std::int64_t before = 0;
    in.read(shares_table,
            {std::uint64_t(parallel::comm_rank(state_->comm)), 1, std::uint64_t(state_->ranks), 1}, &before);
    return before == share;
  });
  state_->same_share = !parallel::any(state_->comm, !same);
  state_->orders.emplace(mesh);
}

bool CheckpointReader::on_same_ranks() const { return memory_ || state_->same_share; }

const std::vector<double>& CheckpointReader::in_memory(const std::string& name) const {
  const auto found = memory_->arrays_.find(name);
  if (found == memory_->arrays_.end()) throw Error("The saved state has no '{}'.", name);
  return found->second;
}

void CheckpointReader::fill(const std::string& name, std::span<double> values,
                            const std::vector<double>& all) const {
  if (!memory_)
    state_->require(name, all.size(), values.size());
  else if (all.size() != values.size())
    throw Error("The saved state has {} values of '{}', but {} are expected.", all.size(), name,
                values.size());
  std::ranges::copy(all, values.begin());
}

std::vector<double> CheckpointReader::read(const FieldEntries& entries, const std::string& name) {
  return memory_ ? in_memory(name) : state_->field(entries.order(state_->orders), name);
}

void CheckpointReader::read(const FieldEntries& entries, const std::string& name, std::span<double> values) {
  fill(name, values, read(entries, name));
}

std::vector<double> CheckpointReader::read_or_none(const FieldEntries& entries, const std::string& name,
                                                   std::size_t width) {
  std::vector<double> values = read(entries, name);
  if (!memory_ && parallel::any(state_->comm, !values.empty()))
    state_->require(name, values.size(), width * entries.order(state_->orders).n_local());
  return values;
}

std::vector<double> CheckpointReader::read_common(const std::string& name) {
  return memory_ ? in_memory(name) : state_->array_of(name, 0);
}

void CheckpointReader::read_common(const std::string& name, std::span<double> values) {
  fill(name, values, read_common(name));
}

std::vector<double> CheckpointReader::read(const std::string& name) {
  return memory_ ? in_memory(name) : state_->own_array(name);
}

void CheckpointReader::read(const std::string& name, std::span<double> values) {
  fill(name, values, read(name));
}

void CheckpointReader::read_sums(const std::string& name, std::span<double> values) {
  if (memory_ || state_->ranks == parallel::comm_size(state_->comm)) return read(name, values);
  std::ranges::fill(values, 0.);
  for (int from = 0; from < state_->ranks; ++from) {
    const std::vector<double> part = state_->array_of(name, from);
    state_->require(name, part.size(), values.size());
    for (std::size_t i = 0; i < part.size() && parallel::comm_rank(state_->comm) == 0; ++i)
      values[i] += part[i];
  }
}

}  // namespace couplet::io
