// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/io/hdf5.hpp"

namespace couplet::io::hdf5 {

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
