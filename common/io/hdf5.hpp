// SPDX-License-Identifier: Apache-2.0
#pragma once
/// A thin cover over the HDF5 C interface: handles that close themselves, failures that become Error; what is written.
/// Reading is hdf5_reader.hpp's. Only files of this name call HDF5.

#include <hdf5.h>
#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

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

/// The one reader of HDF5: a file is foreign until each of its values has been asked for by rank, type and largest
/// size. What is something else is refused with an Error that names the file, the object, what was found and what was
/// expected. No way leads out of the file: soft, external and user-defined links, external storage and virtual tables
/// are refused, filters other than deflate, shuffle and fletcher32 (HDF5 would load a library for them) too. A table is
/// at most as large as the file that holds it; a compressed one may be larger by `most_expansion`.
class Reader final {
 public:
  static constexpr std::uint64_t most_expansion = 64u
                                                  << 20;  ///< [bytes], of a compressed table; also of a chunk
  static constexpr std::uint64_t largest_table = 1ull << 36;  ///< values of one table

  /// On this rank alone; any number of ranks may do so at once. Messages say "The <what> '<file>' cannot be used: ...
  /// <advice>".
  Reader(std::filesystem::path file, std::string what, std::string advice = "");

  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void refuse(const std::string& why) const;

  bool has(const std::string& path) const;
  /// Of the object at `path` ("/": the file itself).
  bool has_attribute(const std::string& path, const std::string& name) const;
  /// One number, of an integer or floating type.
  double number(const std::string& path, const std::string& name) const;
  /// One text of a fixed length of at most `longest` bytes.
  std::string text(const std::string& path, const std::string& name, std::size_t longest = 256) const;

  /// Rows of a table whose rows have `width` values; of width 1 it may also have one dimension.
  std::uint64_t rows(const std::string& path, std::uint64_t width) const;
  /// Rows [first, first + count) of a table that must be total x width, of numbers; the integers are read from integers
  /// only.
  void read(const std::string& path, const Rows& rows, double* values) const;
  void read(const std::string& path, const Rows& rows, std::int64_t* values) const;
  /// A whole table of n rows.
  std::vector<double> table(const std::string& path, std::uint64_t n, std::uint64_t width) const;

  /// Names of the members of a group, in alphabetical order; none if there is no such group. At most `most`.
  std::vector<std::string> members(const std::string& group, std::size_t most = 100000) const;
  /// Paths, below `group`, of all that is not a group there or in the groups below it; at most `most`.
  std::vector<std::string> leaves(const std::string& group, std::size_t most = 100000) const;

 private:
  enum class Kind { numbers, integers };
  struct Table;
  Handle find(const std::string& path) const;
  void add_leaves(const std::string& group, const std::string& below, std::size_t& left,
                  std::vector<std::string>& to) const;
  Handle object(const std::string& path) const;
  Handle attribute(const std::string& path, const std::string& name) const;
  Table open(const std::string& path, Kind kind) const;
  void check_storage(const std::string& path, const Table& table) const;
  void check_filters(const std::string& path, const Handle& storage) const;
  Table open(const std::string& path, Kind kind, const Rows& rows) const;
  void read(const std::string& path, const Table& table, const Rows& rows, hid_t type, void* values) const;

  std::filesystem::path file_;
  std::string what_, advice_;
  std::uint64_t bytes_ = 0;  // of the file
  Handle id_;
};

}  // namespace couplet::io::hdf5
