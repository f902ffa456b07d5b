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

/// A thin cover over the HDF5 C interface: handles that close themselves, failures that become Error; what is written.
/// Reading is hdf5_reader.hpp's. Only files of this name call HDF5.
namespace couplet::io::hdf5 {

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
/// Closes a file that was written, with all that is still on its way. Throws Error with HDF5's reason. Collective.
void close_file(Handle& file);

/// Whether a file that this program is writing has it.
bool exists(hid_t place, const std::string& path);
/// Collective when the file was opened by several ranks; groups on the way are made.
Handle make_group(hid_t place, const std::string& path);
/// A table that this program has written, for its attributes.
Handle open_written(hid_t place, const std::string& table);
void remove(hid_t place, const std::string& path);

/// Rows of a distributed table that this rank holds: [first, first + count) of total, `width` values each.
struct Rows {
  std::uint64_t first = 0, count = 0, total = 0, width = 1;
  int compression = 0;  ///< level of deflate; 0: the table is one block
};
/// The rows of this rank when every rank brings `count`. Collective.
Rows distribute_rows(MPI_Comm comm, std::size_t count, std::size_t width);

/// One table of doubles or 64-bit integers, written by all ranks together (collective). Width 1 makes a 1-D
/// table.
void write_table(hid_t place, const std::string& path, const Rows& rows, const double* values);
void write_table(hid_t place, const std::string& path, const Rows& rows, const std::int64_t* values);
/// The same value on all ranks (collective).
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, const std::string& text);
/// Throws the text of the lowest rank that has one, on every rank; does nothing when all are empty.
/// Collective.
void throw_together(MPI_Comm comm, const std::string& text);

}  // namespace couplet::io::hdf5
