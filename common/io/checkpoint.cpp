// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>

#include "common/base/own_file.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/hdf5_reader.hpp"
#include "common/io/rehearse.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

constexpr const char* checkpoint_format = "couplet checkpoint";
// 3: errors of steps, net heat of a tank's report, what the pressure preconditioner was made from. 4: order of the errors.
constexpr int format_version = 4;

// FNV-1a over the bit patterns: cheap, and any flipped bit of an array is noticed when it is read.
std::int64_t checksum(std::span<const double> values) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const double value : values) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 1099511628211ull;
    hash ^= hash >> 29;
  }
  std::int64_t result = 0;
  std::memcpy(&result, &hash, sizeof result);
  return result;
}

std::string array_path(const std::string& name) { return "arrays/" + name; }
std::string layout_path(const std::string& name) { return "layout/" + name; }
std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}
std::string scalar_path(const std::string& name) { return "scalars/" + name; }

}  // namespace

struct CheckpointWriter::State {
  MPI_Comm comm;
  std::filesystem::path file, part;
  hdf5::Handle id;
  int exceptions = std::uncaught_exceptions();
};

CheckpointWriter::CheckpointWriter(MPI_Comm comm, const std::filesystem::path& file)
    : state_(std::make_unique<State>()) {
  state_->comm = comm;
  state_->file = file;
  state_->part = file.string() + ".part";
  std::string trouble;
  if (parallel::comm_rank(comm) == 0) {
    std::error_code code;
    const std::filesystem::path folder = folder_of(file);
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
      trouble = fmt::format("Cannot create the folder '{}' for the checkpoint '{}' ({}).", folder.string(),
                            file.string(), code.message());
    else if (::access(folder.c_str(), W_OK) != 0)
      trouble = fmt::format("Cannot write to the folder '{}' of the checkpoint '{}'.", folder.string(),
                            file.string());
  }
  hdf5::throw_together(comm, trouble);
  std::string stamp = parallel::comm_rank(comm) == 0 ? stamp_being_written(folder_of(file)) : "";
  if (stamp.empty()) stamp = "alone";
  parallel::broadcast(comm, stamp);
  state_->id = hdf5::create_file(comm, state_->part);
  hdf5::write_attribute(state_->id, "format", std::string(checkpoint_format));
  hdf5::write_attribute(state_->id, "version", double(format_version));
  hdf5::write_attribute(state_->id, "ranks", double(parallel::comm_size(comm)));
  hdf5::write_attribute(state_->id, "set", stamp);
}

CheckpointWriter::CheckpointWriter(StateInMemory& memory) : memory_(&memory) {}

CheckpointWriter::~CheckpointWriter() {
  if (memory_ || state_->id < 0) return;
  // Closing a file is collective: never while unwinding, when the other ranks may be elsewhere.
  if (std::uncaught_exceptions() > state_->exceptions) {
    state_->id.release();
    return;
  }
  state_->id.reset();
  std::error_code ignored;
  if (parallel::comm_rank(state_->comm) == 0) std::filesystem::remove(state_->part, ignored);
}

void CheckpointWriter::write(const std::string& name, std::span<const double> values) {
  if (memory_) {
    memory_->arrays_[name].assign(values.begin(), values.end());
    return;
  }
  if (hdf5::exists(state_->id, array_path(name)))
    throw Error("The checkpoint '{}' received the array '{}' twice.", state_->file.string(), name);
  const hdf5::Rows rows = hdf5::distribute_rows(state_->comm, values.size(), 1);
  hdf5::write_table(state_->id, array_path(name), rows, values.data());
  const std::int64_t layout[2] = {static_cast<std::int64_t>(values.size()), checksum(values)};
  hdf5::write_table(state_->id, layout_path(name), hdf5::distribute_rows(state_->comm, 1, 2), layout);
}

void CheckpointWriter::write_scalar(const std::string& name, double value) {
  if (memory_) {
    memory_->arrays_[scalar_path(name)] = {value};
    return;
  }
  MPI_Bcast(&value, 1, MPI_DOUBLE, 0, state_->comm);
  const bool root = parallel::comm_rank(state_->comm) == 0;
  hdf5::write_table(state_->id, scalar_path(name), hdf5::distribute_rows(state_->comm, root ? 1 : 0, 1),
                    &value);
}

void CheckpointWriter::close() {
  if (memory_ || state_->id < 0) return;
  std::string trouble;
  try {
    hdf5::close_file(state_->id);
  } catch (const Error& error) {
    trouble =
        fmt::format("Cannot write the checkpoint '{}' ({}). The last good one is kept; is the disk full?",
                    state_->file.string(), error.what());
  }
  hdf5::throw_together(state_->comm, trouble);
  if (parallel::comm_rank(state_->comm) == 0) {
    base::flush_to_disk(state_->part);
    std::error_code code;
    std::filesystem::rename(state_->part, state_->file, code);
    if (code)
      trouble = fmt::format("Cannot rename the finished checkpoint to '{}' ({}).", state_->file.string(),
                            code.message());
    else
      base::flush_to_disk(state_->file.has_parent_path() ? state_->file.parent_path()
                                                         : std::filesystem::path("."));
  }
  hdf5::throw_together(state_->comm, trouble);
}

namespace {

constexpr const char* what = "checkpoint";
constexpr const char* advice = "Use an earlier one.";

hdf5::Reader open(const std::filesystem::path& file) { return {file, what, advice}; }

/// Values that each rank wrote and their checksums, from rank 0 on.
std::vector<std::int64_t> layout_of(const hdf5::Reader& in, const std::string& name, int ranks) {
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

double scalar_of(const hdf5::Reader& in, const std::string& name) {
  double value = 0;
  in.read(scalar_path(name), {0, 1, 1, 1}, &value);
  return value;
}

/// Whether the stamp in the file is that of the set it lies in.
void examine_stamp(const hdf5::Reader& in) {
  const auto set = read_checkpoint_set(folder_of(in.file()));
  if (!set || in.text("/", "set", 1024) == set->stamp.text()) return;
  throw Error(
      "'{}' is from another step or another run than the checkpoint that contains it (step {}, t = {:g} s "
      "of run {}).",
      in.file().string(), set->stamp.step, set->stamp.time, set->stamp.run);
}

/// All of the file but the arrays' values, which HDF5 copies as they are. `ranks`: of this run; 0: any.
void examine_content(const hdf5::Reader& in, int ranks) {
  if (!in.has_attribute("/", "format") || in.text("/", "format") != checkpoint_format)
    throw Error("'{}' is an HDF5 file, but not a checkpoint.", in.file().string());
  if (const double version = in.number("/", "version"); version != format_version)
    throw Error("The checkpoint '{}' has format version {}; this program reads version {}.",
                in.file().string(), version, format_version);
  const double written = in.number("/", "ranks");
  if (!(written >= 1 && written < 1e8)) in.refuse(fmt::format("it was written on {} ranks", written));
  if (ranks > 0 && written != ranks)
    throw Error(
        "The checkpoint '{}' was written on {} {}, this run has {}. Restart on the same number of ranks.",
        in.file().string(), written, written == 1 ? "rank" : "ranks", ranks);
  examine_stamp(in);
  for (const std::string& name : in.leaves("arrays")) layout_of(in, name, int(written));
  for (const std::string& name : in.leaves("scalars")) scalar_of(in, name);
}

/// The file as a whole, in a process of its own. Its digest is compared before HDF5 sees it.
void examine(const std::filesystem::path& file, int ranks) {
  if (!std::filesystem::exists(file)) throw Error("The checkpoint '{}' does not exist.", file.string());
  if (const std::string problem = problem_in_set(file); !problem.empty()) throw Error(problem);
  rehearse(file, what, [&] { examine_content(open(file), ranks); });
}

}  // namespace

std::string problem_of_checkpoint(const std::filesystem::path& file) {
  try {
    examine(file, 0);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

struct CheckpointReader::State {
  MPI_Comm comm;
  hdf5::Reader in;

  /// What `read` throws on some rank is thrown on all.
  template <class Read>
  auto together(Read read) const {
    std::string trouble;
    decltype(read()) result{};
    try {
      result = read();
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
    return result;
  }

  // This rank's rows of an array and its checksum; the reading is local, the verdict is common.
  std::pair<hdf5::Rows, std::int64_t> rows_of(const std::string& name) const {
    return together([&] {
      if (!in.has(array_path(name)) || !in.has(layout_path(name)))
        throw Error(
            "The checkpoint '{}' has no array '{}'. It was written by another program or another case.",
            in.file().string(), name);
      const int size = parallel::comm_size(comm), rank = parallel::comm_rank(comm);
      const std::vector<std::int64_t> layout = layout_of(in, name, size);
      hdf5::Rows rows;
      for (int r = 0; r < size; ++r) {
        if (r < rank) rows.first += std::uint64_t(layout[2 * r]);
        rows.total += std::uint64_t(layout[2 * r]);
      }
      rows.count = std::uint64_t(layout[2 * rank]);
      return std::pair(rows, layout[2 * rank + 1]);
    });
  }

  void fill(const std::string& name, const hdf5::Rows& rows, std::int64_t wanted,
            std::span<double> values) const {
    together([&] {
      in.read(array_path(name), rows, values.data());
      if (checksum(values) != wanted)
        throw Error(
            "The checkpoint '{}' is corrupted: wrong checksum of the array '{}' on rank {}. Use an earlier "
            "checkpoint.",
            in.file().string(), name, parallel::comm_rank(comm));
      return 0;
    });
  }
};

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& file) {
  std::string trouble;
  const auto attempt = [&](auto&& act) {
    try {
      act();
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
  };
  attempt([&] {
    if (parallel::comm_rank(comm) == 0) examine(file, parallel::comm_size(comm));
  });
  attempt([&] { state_ = std::make_unique<State>(State{comm, open(file)}); });
}

// The file was opened by this rank alone, so closing it is local.
CheckpointReader::~CheckpointReader() = default;

CheckpointReader::CheckpointReader(const StateInMemory& memory) : memory_(&memory) {}

const std::vector<double>& CheckpointReader::in_memory(const std::string& name) const {
  const auto found = memory_->arrays_.find(name);
  if (found == memory_->arrays_.end()) throw Error("The saved state has no '{}'.", name);
  return found->second;
}

void CheckpointReader::read(const std::string& name, std::span<double> values) {
  if (memory_) {
    const std::vector<double>& kept = in_memory(name);
    if (kept.size() != values.size())
      throw Error("The saved state has {} values of '{}', but {} are expected.", kept.size(), name,
                  values.size());
    std::copy(kept.begin(), kept.end(), values.begin());
    return;
  }
  const auto [rows, wanted] = state_->rows_of(name);
  std::string trouble;
  if (rows.count != values.size())
    trouble = fmt::format(
        "The checkpoint '{}' has {} values of '{}' on rank {}, but {} are expected. Is it from the same "
        "mesh?",
        state_->in.file().string(), rows.count, name, parallel::comm_rank(state_->comm), values.size());
  hdf5::throw_together(state_->comm, trouble);
  state_->fill(name, rows, wanted, values);
}

std::vector<double> CheckpointReader::read(const std::string& name) {
  if (memory_) return in_memory(name);
  const auto [rows, wanted] = state_->rows_of(name);
  std::vector<double> values(rows.count);
  state_->fill(name, rows, wanted, values);
  return values;
}

std::vector<double> CheckpointReader::read_or_none(const std::string& name, std::size_t n) {
  std::vector<double> values = read(name);
  std::string trouble;
  if (!values.empty() && values.size() != n)
    trouble = fmt::format(
        "The {} has {} values of '{}', but {} or none are expected. Is it of the same case?",
        memory_ ? std::string("saved state") : fmt::format("checkpoint '{}'", state_->in.file().string()),
        values.size(), name, n);
  if (memory_ && !trouble.empty()) throw Error(trouble);
  if (!memory_) hdf5::throw_together(state_->comm, trouble);
  return values;
}

std::size_t CheckpointReader::read_count(const std::string& name, std::size_t most) {
  const double value = read_scalar(name);
  if (!(value >= 0 && value <= double(most)) || value != std::floor(value))
    throw Error(
        "The {} gives {} as '{}'; expected a whole number from 0 to {}.",
        memory_ ? std::string("saved state") : fmt::format("checkpoint '{}'", state_->in.file().string()),
        value, name, most);
  return static_cast<std::size_t>(value);
}

double CheckpointReader::read_scalar(const std::string& name) {
  if (memory_) return in_memory(scalar_path(name)).front();
  return state_->together([&] {
    if (!state_->in.has(scalar_path(name)))
      throw Error("The checkpoint '{}' has no value '{}'. It was written by another program or another case.",
                  state_->in.file().string(), name);
    return scalar_of(state_->in, name);
  });
}

}  // namespace couplet::io
