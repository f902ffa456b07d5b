// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Thin wrapper of the HDF5 C interface for writing, with handles that close themselves and failures that
/// become Error. hdf5_reader.hpp reads. Only hdf5*.cpp call HDF5.

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace couplet::io::hdf5 {

/// Suppresses HDF5's error stack while alive. Our own message quotes its first reason instead.
class Quiet final {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Innermost entry of HDF5's error stack, e.g. "truncated file: eof = 96, ...".
std::string reason();

/// Id with its closing function. Closing anything but a file is local to the rank and therefore safe during
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
  /// Releases the id without closing it.
  hid_t release() { return std::exchange(id_, -1); }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Creates a file. Throws Error with its name. Collective over comm.
Handle create_file(MPI_Comm comm, const std::filesystem::path& file);
Handle open_file_to_write(MPI_Comm comm, const std::filesystem::path& file);
/// Closes a written file after flushing it. Throws Error with its name on all ranks if one of them fails.
void close_file(MPI_Comm comm, Handle& file, const std::filesystem::path& name);

/// Returns true if a file that this program is writing contains `path`.
bool exists(hid_t place, const std::string& path);
/// Creates a group and its parents. Collective if several ranks opened the file.
Handle make_group(hid_t place, const std::string& path);
/// Opens a table that this program has written, to add attributes.
Handle open_written(hid_t place, const std::string& table);
void remove(hid_t place, const std::string& path);

/// Rows [first, first + count) of a distributed table that this rank holds, with `width` values each.
struct RowSpan {
  std::uint64_t first = 0, count = 0, total = 0, width = 1;
  int compression = 0;  ///< level of deflate; 0 writes the table as one block
};
/// Rows of this rank if every rank contributes `count`. Collective.
RowSpan distribute_rows(MPI_Comm comm, std::size_t count, std::size_t width);

/// Writes a table of doubles or 64-bit integers from all ranks. Width 1 makes a 1-D table. Collective.
void write_table(hid_t place, const std::string& path, const RowSpan& rows, const double* values);
void write_table(hid_t place, const std::string& path, const RowSpan& rows, const std::int64_t* values);
/// Writes an attribute with the same value on all ranks. Collective.
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, const std::string& text);

/// Reader of HDF5 files. It treats a file as foreign: each value is requested by rank, type and largest size.
/// Anything else throws an Error with file, object, found and expected content. Soft, external and
/// user-defined links, external storage and virtual tables are rejected. So are filters other than deflate,
/// shuffle and fletcher32, for which HDF5 would load a library. A compressed table may exceed its file size
/// by `most_expansion`.
class Reader final {
 public:
  /// Limit on the size of a compressed table beyond that of the file, and of a chunk [bytes].
  static constexpr std::uint64_t most_expansion = 64u << 20;
  static constexpr std::uint64_t largest_table = 1ull << 36;  ///< values of one table

  /// Opens the file on this rank; any number of ranks may do so at once. Messages say "The <what> '<file>'
  /// cannot be used: ... <advice>".
  Reader(std::filesystem::path file, std::string what, std::string advice = "");

  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void refuse(const std::string& why) const;

  bool has(const std::string& path) const;
  /// Checks for an attribute of the object at `path` ("/" is the file itself).
  bool has_attribute(const std::string& path, const std::string& name) const;
  /// Reads one number of an integer or floating-point type.
  double number(const std::string& path, const std::string& name) const;
  /// Reads one text of fixed length, at most `longest` bytes.
  std::string text(const std::string& path, const std::string& name, std::size_t longest = 256) const;

  /// Number of rows of a table whose rows have `width` values. With width 1 it may also be one-dimensional.
  std::uint64_t rows(const std::string& path, std::uint64_t width) const;
  /// Reads rows [first, first + count) of a numeric table that must be total x width. Integers are read only
  /// from integers.
  void read(const std::string& path, const RowSpan& rows, double* values) const;
  void read(const std::string& path, const RowSpan& rows, std::int64_t* values) const;
  /// Reads a whole table of n rows.
  std::vector<double> table(const std::string& path, std::uint64_t n, std::uint64_t width) const;

  /// Names of the members of a group in alphabetical order, at most `most`. Empty if there is no such group.
  std::vector<std::string> members(const std::string& group, std::size_t most = 100000) const;
  /// Paths relative to `group` of everything below it that is not a group, at most `most`.
  std::vector<std::string> leaves(const std::string& group, std::size_t most = 100000) const;

 private:
  enum class Kind { numbers, integers };
  struct Dataset;
  Handle find(const std::string& path) const;
  void add_leaves(const std::string& group, const std::string& below, std::size_t& left,
                  std::vector<std::string>& to) const;
  Handle object(const std::string& path) const;
  Handle attribute(const std::string& path, const std::string& name) const;
  Dataset open(const std::string& path, Kind kind) const;
  void check_storage(const std::string& path, const Dataset& table) const;
  void check_filters(const std::string& path, const Handle& storage) const;
  Dataset open(const std::string& path, Kind kind, const RowSpan& rows) const;
  void read(const std::string& path, const Dataset& in, const RowSpan& rows, hid_t type, void* values) const;

  std::filesystem::path file_;
  std::string what_, advice_;
  std::uint64_t bytes_ = 0;  // size of the file
  Handle id_;
};

}  // namespace couplet::io::hdf5
