// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

/// A thin cover over the HDF5 C interface: handles that close themselves, failures that become Error. Only
/// this folder sees hdf5.h.
namespace couplet::hdf5 {

/// Keeps HDF5 from printing its error stack while alive: the first reason goes into our own message instead.
class Quiet final {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// The innermost entry of HDF5's error stack, e.g. "truncated file: eof = 96, ...".
std::string reason();

/// An id with its closing function. Closing anything but a file is local to the rank, so it is safe while
/// unwinding.
class Handle final {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Handle() { reset(); }
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = -1;
  }
  /// Gives the id up without closing it.
  hid_t release() { return std::exchange(id_, -1); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Collective over comm. Throws Error naming the file.
Handle create_file(MPI_Comm comm, const std::filesystem::path& file);
Handle open_file_to_write(MPI_Comm comm, const std::filesystem::path& file);
/// On this rank alone; any number of ranks may do so at once.
Handle open_file_to_read(const std::filesystem::path& file);

bool exists(hid_t place, const std::string& path);
/// Collective when the file was opened by several ranks; groups on the way are made.
Handle make_group(hid_t place, const std::string& path);

/// Rows of a distributed table that this rank holds: [first, first + count) of total, `width` values each.
struct Rows {
  std::uint64_t first = 0, count = 0, total = 0, width = 1;
};
/// The rows of this rank when every rank brings `count`. Collective.
Rows distribute_rows(MPI_Comm comm, std::size_t count, std::size_t width);

/// One table of doubles or 64-bit integers, written by all ranks together (collective). Width 1 makes a 1-D
/// table.
void write_table(hid_t place, const std::string& path, const Rows& rows, const double* values);
void write_table(hid_t place, const std::string& path, const Rows& rows, const std::int64_t* values);
/// This rank alone reads its rows.
void read_table(hid_t place, const std::string& path, const Rows& rows, double* values);
void read_table(hid_t place, const std::string& path, const Rows& rows, std::int64_t* values);
/// Number of rows of a table.
std::uint64_t table_length(hid_t place, const std::string& path);

/// The same value on all ranks (collective).
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, const std::string& text);
/// Throws Error if there is no such attribute.
double read_attribute(hid_t object, const std::string& name);
std::string read_text_attribute(hid_t object, const std::string& name);

/// Names of the members of a group, in alphabetical order.
std::vector<std::string> members(hid_t place, const std::string& group);

/// Throws the text of the lowest rank that has one, on every rank; does nothing when all are empty.
/// Collective.
void throw_together(MPI_Comm comm, const std::string& text);

}  // namespace couplet::hdf5
