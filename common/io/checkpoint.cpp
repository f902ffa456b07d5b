// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <exception>

#include "common/base/own_file.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/hdf5.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

constexpr const char* format_name = "couplet checkpoint";
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
  if (comm_rank(comm) == 0) {
    std::error_code code;
    const std::filesystem::path folder = folder_of(file);
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
      trouble = fmt::format("The folder '{}' for the checkpoint '{}' could not be made ({}).",
                            folder.string(), file.string(), code.message());
    else if (::access(folder.c_str(), W_OK) != 0)
      trouble = fmt::format("The folder '{}' for the checkpoint '{}' cannot be written to.", folder.string(),
                            file.string());
  }
  hdf5::throw_together(comm, trouble);
  std::string stamp = comm_rank(comm) == 0 ? stamp_being_written(folder_of(file)) : "";
  if (stamp.empty()) stamp = "alone";
  broadcast(comm, stamp);
  state_->id = hdf5::create_file(comm, state_->part);
  hdf5::write_attribute(state_->id, "format", std::string(format_name));
  hdf5::write_attribute(state_->id, "version", double(format_version));
  hdf5::write_attribute(state_->id, "ranks", double(comm_size(comm)));
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
  if (comm_rank(state_->comm) == 0) std::filesystem::remove(state_->part, ignored);
}

void CheckpointWriter::write(const std::string& name, std::span<const double> values) {
  if (memory_) {
    memory_->arrays_[name].assign(values.begin(), values.end());
    return;
  }
  if (hdf5::exists(state_->id, array_path(name)))
    throw Error("The checkpoint '{}' got the array '{}' twice.", state_->file.string(), name);
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
  const bool root = comm_rank(state_->comm) == 0;
  hdf5::write_table(state_->id, scalar_path(name), hdf5::distribute_rows(state_->comm, root ? 1 : 0, 1),
                    &value);
}

void CheckpointWriter::close() {
  if (memory_ || state_->id < 0) return;
  std::string trouble;
  {
    const hdf5::Quiet quiet;
    if (H5Fclose(state_->id.release()) < 0)
      trouble = fmt::format(
          "The checkpoint '{}' could not be written ({}). The last good one is kept; is the disk full?",
          state_->file.string(), hdf5::reason());
  }
  hdf5::throw_together(state_->comm, trouble);
  if (comm_rank(state_->comm) == 0) {
    flush_to_disk(state_->part);
    std::error_code code;
    std::filesystem::rename(state_->part, state_->file, code);
    if (code)
      trouble = fmt::format("The checkpoint '{}' could not be put in place ({}).", state_->file.string(),
                            code.message());
    else
      flush_to_disk(state_->file.has_parent_path() ? state_->file.parent_path() : std::filesystem::path("."));
  }
  hdf5::throw_together(state_->comm, trouble);
}

struct CheckpointReader::State {
  MPI_Comm comm;
  std::filesystem::path file;
  hdf5::Handle id;

  // This rank's rows of an array and its checksum; the reading is local, the verdict is common.
  std::pair<hdf5::Rows, std::int64_t> rows_of(const std::string& name) const {
    std::string trouble;
    hdf5::Rows rows;
    std::int64_t wanted = 0;
    try {
      if (!hdf5::exists(id, array_path(name)) || !hdf5::exists(id, layout_path(name)))
        throw Error(
            "The checkpoint '{}' has no array '{}'. It was written by another program or another case.",
            file.string(), name);
      const int size = comm_size(comm), rank = comm_rank(comm);
      std::vector<std::int64_t> layout(2 * std::size_t(size));
      if (hdf5::table_length(id, layout_path(name)) != std::uint64_t(size))
        throw Error("The checkpoint '{}' is corrupted: the layout of '{}' is not that of {} ranks.",
                    file.string(), name, size);
      hdf5::read_table(id, layout_path(name), {0, std::uint64_t(size), std::uint64_t(size), 2},
                       layout.data());
      for (int r = 0; r < size; ++r) {
        if (r < rank) rows.first += std::uint64_t(layout[2 * r]);
        rows.total += std::uint64_t(layout[2 * r]);
      }
      rows.count = std::uint64_t(layout[2 * rank]);
      wanted = layout[2 * rank + 1];
      if (hdf5::table_length(id, array_path(name)) != rows.total)
        throw Error("The checkpoint '{}' is corrupted: the array '{}' has {} values, its layout says {}.",
                    file.string(), name, hdf5::table_length(id, array_path(name)), rows.total);
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
    return {rows, wanted};
  }

  void fill(const std::string& name, const hdf5::Rows& rows, std::int64_t wanted,
            std::span<double> values) const {
    std::string trouble;
    try {
      hdf5::read_table(id, array_path(name), rows, values.data());
      if (checksum(values) != wanted)
        throw Error(
            "The checkpoint '{}' is corrupted: the checksum of the array '{}' is wrong on rank {}. Use an "
            "earlier "
            "checkpoint.",
            file.string(), name, comm_rank(comm));
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
  }
};

namespace {

// Whether the stamp in the file is that of the set it lies in.
std::string examine_stamp(const std::filesystem::path& file, const hdf5::Handle& id) {
  const auto set = read_checkpoint_set(folder_of(file));
  if (!set || hdf5::read_text_attribute(id, "set") == set->stamp.text()) return {};
  return fmt::format(
      "'{}' was written at another step or by another run than the checkpoint it lies in (step {}, t = {:g} s of "
      "run {}).",
      file.string(), set->stamp.step, set->stamp.time, set->stamp.run);
}

// What is wrong with the file as a whole; empty if nothing. Its digest is compared before HDF5 sees it.
std::string examine(const std::filesystem::path& file, int ranks) {
  if (!std::filesystem::exists(file)) return fmt::format("There is no checkpoint '{}'.", file.string());
  try {
    if (std::string problem = problem_in_set(file); !problem.empty()) return problem;
  } catch (const Error& error) {
    return error.what();
  }
  const hdf5::Quiet quiet;
  if (H5Fis_hdf5(file.c_str()) <= 0)
    return fmt::format("'{}' is not a checkpoint: it is not an HDF5 file, or its beginning is damaged.",
                       file.string());
  try {
    const hdf5::Handle id = hdf5::open_file_to_read(file);
    if (H5Aexists(id, "format") <= 0 || hdf5::read_text_attribute(id, "format") != format_name)
      return fmt::format("'{}' is an HDF5 file, but not a checkpoint.", file.string());
    const int version = static_cast<int>(hdf5::read_attribute(id, "version"));
    if (version != format_version)
      return fmt::format("The checkpoint '{}' has format version {}; this program reads version {}.",
                         file.string(), version, format_version);
    const int written = static_cast<int>(hdf5::read_attribute(id, "ranks"));
    if (written != ranks)
      return fmt::format(
          "The checkpoint '{}' was written on {} {}, this run has {}. Restart on the same number of ranks.",
          file.string(), written, written == 1 ? "rank" : "ranks", ranks);
    return examine_stamp(file, id);
  } catch (const Error& error) {
    return fmt::format("The checkpoint '{}' is truncated or corrupted. Use an earlier one. {}", file.string(),
                       error.what());
  }
  return {};
}

}  // namespace

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& file)
    : state_(std::make_unique<State>()) {
  std::string trouble;
  if (comm_rank(comm) == 0) trouble = examine(file, comm_size(comm));
  hdf5::throw_together(comm, trouble);
  state_->comm = comm;
  state_->file = file;
  try {
    state_->id = hdf5::open_file_to_read(file);
  } catch (const Error& error) {
    trouble = error.what();
  }
  hdf5::throw_together(comm, trouble);
}

// The file was opened by this rank alone, so closing it is local.
CheckpointReader::~CheckpointReader() = default;

CheckpointReader::CheckpointReader(const StateInMemory& memory) : memory_(&memory) {}

const std::vector<double>& CheckpointReader::in_memory(const std::string& name) const {
  const auto found = memory_->arrays_.find(name);
  if (found == memory_->arrays_.end()) throw Error("The state in memory has no '{}'.", name);
  return found->second;
}

void CheckpointReader::read(const std::string& name, std::span<double> values) {
  if (memory_) {
    const std::vector<double>& kept = in_memory(name);
    if (kept.size() != values.size())
      throw Error("The state in memory holds {} values of '{}', but {} are expected.", kept.size(), name,
                  values.size());
    std::copy(kept.begin(), kept.end(), values.begin());
    return;
  }
  const auto [rows, wanted] = state_->rows_of(name);
  std::string trouble;
  if (rows.count != values.size())
    trouble = fmt::format(
        "The checkpoint '{}' holds {} values of '{}' on rank {}, but {} are expected. Is it from the same "
        "mesh?",
        state_->file.string(), rows.count, name, comm_rank(state_->comm), values.size());
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

double CheckpointReader::read_scalar(const std::string& name) {
  if (memory_) return in_memory(scalar_path(name)).front();
  std::string trouble;
  double value = 0;
  try {
    if (!hdf5::exists(state_->id, scalar_path(name)))
      throw Error("The checkpoint '{}' has no value '{}'. It was written by another program or another case.",
                  state_->file.string(), name);
    hdf5::read_table(state_->id, scalar_path(name), {0, 1, 1, 1}, &value);
  } catch (const Error& error) {
    trouble = error.what();
  }
  hdf5::throw_together(state_->comm, trouble);
  return value;
}

}  // namespace couplet
