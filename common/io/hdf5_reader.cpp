// SPDX-License-Identifier: Apache-2.0
#include "common/io/hdf5.hpp"

#include <fmt/format.h>
#include <hdf5.h>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/text.hpp"

namespace couplet::io::hdf5 {
namespace {

/// Dimensions of a dataspace; a single value has none. Not sound if empty or with more than four dimensions.
struct DataShape {
  bool sound = false;
  std::vector<std::uint64_t> size;
  std::string text() const;
  bool is_one_value() const;
};

/// Checks for a standard numeric type in either byte order. All others are rejected.
bool is_integer(hid_t type) {
  const std::size_t size = H5Tget_size(type);
  return H5Tget_class(type) == H5T_INTEGER && H5Tget_precision(type) == 8 * size &&
         (size == 1 || size == 2 || size == 4 || size == 8);
}

bool is_real(hid_t type) {
  for (const hid_t known : {H5T_IEEE_F64LE, H5T_IEEE_F64BE, H5T_IEEE_F32LE, H5T_IEEE_F32BE})
    if (H5Tequal(type, known) > 0) return true;
  return false;
}

/// Name of a type for messages: "float64", "text of 14 bytes", "a compound type".
std::string name_of(hid_t type) {
  const std::size_t size = H5Tget_size(type);
  if (is_integer(type)) return fmt::format("{}int{}", H5Tget_sign(type) == H5T_SGN_NONE ? "u" : "", 8 * size);
  if (is_real(type)) return fmt::format("float{}", 8 * size);
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return fmt::format("an unusual integer of {} bytes", size);
    case H5T_FLOAT:
      return fmt::format("an unusual floating-point number of {} bytes", size);
    case H5T_STRING:
      return H5Tis_variable_str(type) > 0 ? std::string("text of variable length")
                                          : fmt::format("text of {} bytes", size);
    case H5T_COMPOUND:
      return "a compound type";
    case H5T_REFERENCE:
      return "a reference";
    case H5T_ENUM:
      return "an enumeration";
    case H5T_VLEN:
      return "lists of variable length";
    case H5T_ARRAY:
      return "arrays";
    default:
      return "another type";
  }
}

std::string DataShape::text() const {
  if (!sound) return "no values or too many dimensions";
  if (size.empty()) return "one value";
  std::vector<std::string> words;
  for (const std::uint64_t n : size) words.push_back(std::to_string(n));
  return base::join(words, " x ") + (size.size() == 1 ? " values" : " table");
}

bool DataShape::is_one_value() const {
  return sound && std::ranges::all_of(size, [](std::uint64_t n) { return n == 1; });
}

DataShape shape_of(hid_t space) {
  DataShape shape;
  const H5S_class_t kind = H5Sget_simple_extent_type(space);
  if (kind == H5S_SCALAR) shape.sound = true;
  if (kind != H5S_SIMPLE) return shape;
  hsize_t size[H5S_MAX_RANK] = {0};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1 || rank > 4 || H5Sget_simple_extent_dims(space, size, nullptr) != rank) return shape;
  shape.size.assign(size, size + rank);
  shape.sound = true;
  return shape;
}

constexpr std::size_t deepest = 16;  // nested groups

const char* name_of_link(H5L_type_t type) {
  return type == H5L_TYPE_SOFT       ? "a soft link"
         : type == H5L_TYPE_EXTERNAL ? "a link to another file"
                                     : "an unknown kind of link";
}

}  // namespace

struct Reader::Dataset {
  Handle id, type, space;
  std::uint64_t rows = 0, width = 1;
  bool is_flat = true;  // one dimension
  std::uint64_t bytes = 0;
};

Reader::Reader(std::filesystem::path file, std::string what, std::string advice)
    : file_(std::move(file)), what_(std::move(what)), advice_(std::move(advice)) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file_, failed)) refuse("there is no such file");
  bytes_ = std::filesystem::file_size(file_, failed);
  if (failed) refuse(failed.message());
  const Quiet quiet;
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access, false, true);
  id_ = Handle(H5Fopen(file_.c_str(), H5F_ACC_RDONLY, access), H5Fclose);
  if (id_ < 0) refuse(fmt::format("it is not an HDF5 file, or its beginning is damaged ({})", reason()));
}

void Reader::refuse(const std::string& why) const {
  throw Error("Cannot use the {} '{}': {}.{}{}", what_, file_.string(), why, advice_.empty() ? "" : " ",
              advice_);
}

// Opens the object at `path` by hard links. The handle is invalid if there is none.
Handle Reader::find(const std::string& path) const {
  const Quiet quiet;
  Handle at(H5Oopen(id_, "/", H5P_DEFAULT), H5Oclose);
  if (at < 0) refuse(fmt::format("cannot open its root group ({})", reason()));
  const std::vector<std::string> parts = base::split(path, '/');
  if (parts.size() > deepest) refuse(fmt::format("'{}' is nested deeper than {} groups", path, deepest));
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    if (H5Iget_type(at) != H5I_GROUP)
      refuse(fmt::format("the path to '{}' leads through an object that is not a group", path));
    const htri_t there = H5Lexists(at, part.c_str(), H5P_DEFAULT);
    if (there == 0) return {};
    H5L_info_t link;
    if (there < 0 || H5Lget_info(at, part.c_str(), &link, H5P_DEFAULT) < 0)
      refuse(fmt::format("cannot find '{}' ({})", path, reason()));
    if (link.type != H5L_TYPE_HARD)
      refuse(fmt::format("'{}' of the path '{}' is {}; expected an object in the file itself", part, path,
                         name_of_link(link.type)));
    Handle next(H5Oopen(at, part.c_str(), H5P_DEFAULT), H5Oclose);
    if (next < 0) refuse(fmt::format("cannot open '{}' ({})", path, reason()));
    at = std::move(next);
  }
  return at;
}

bool Reader::has(const std::string& path) const { return find(path) >= 0; }

Handle Reader::object(const std::string& path) const {
  Handle found = find(path);
  if (found < 0) refuse(fmt::format("it has no '{}'", path));
  return found;
}

bool Reader::has_attribute(const std::string& path, const std::string& name) const {
  const Handle owner = object(path);
  const Quiet quiet;
  return H5Aexists(owner, name.c_str()) > 0;
}

Handle Reader::attribute(const std::string& path, const std::string& name) const {
  const Handle owner = object(path);
  const Quiet quiet;
  if (H5Aexists(owner, name.c_str()) <= 0) refuse(fmt::format("'{}' has no attribute '{}'", path, name));
  Handle found(H5Aopen(owner, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (found < 0) refuse(fmt::format("cannot open the attribute '{}' of '{}' ({})", name, path, reason()));
  return found;
}

double Reader::number(const std::string& path, const std::string& name) const {
  const Handle found = attribute(path, name);
  const Quiet quiet;
  const Handle type(H5Aget_type(found), H5Tclose), space(H5Aget_space(found), H5Sclose);
  const DataShape shape = shape_of(space);
  if (!shape.is_one_value() || !(is_real(type) || is_integer(type)))
    refuse(fmt::format("the attribute '{}' of '{}' contains {} ({}); expected one number", name, path,
                       shape.text(), name_of(type)));
  double value = 0;
  if (H5Aread(found, H5T_NATIVE_DOUBLE, &value) < 0)
    refuse(fmt::format("cannot read the attribute '{}' of '{}' ({})", name, path, reason()));
  return value;
}

std::string Reader::text(const std::string& path, const std::string& name, std::size_t longest) const {
  const Handle found = attribute(path, name);
  const Quiet quiet;
  const Handle type(H5Aget_type(found), H5Tclose), space(H5Aget_space(found), H5Sclose);
  const DataShape shape = shape_of(space);
  const std::size_t size = type < 0 ? 0 : H5Tget_size(type);
  if (!shape.is_one_value() || H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 ||
      size == 0 || size > longest)
    refuse(fmt::format(
        "the attribute '{}' of '{}' contains {} ({}); expected one fixed-length text of at most {} bytes",
        name, path, shape.text(), name_of(type), longest));
  std::string text(size, '\0');
  if (H5Aread(found, type, text.data()) < 0)
    refuse(fmt::format("cannot read the attribute '{}' of '{}' ({})", name, path, reason()));
  text.resize(text.find_last_not_of('\0') + 1);  // padding
  return text;
}

void Reader::check_filters(const std::string& path, const Handle& storage) const {
  const int n = H5Pget_nfilters(storage);
  if (n < 0 || n > 4) refuse(fmt::format("the table '{}' has {} filters; at most 4 are supported", path, n));
  for (int i = 0; i < n; ++i) {
    unsigned flags = 0, values[8];
    std::size_t n_values = 8;
    char name[64];
    const H5Z_filter_t filter =
        H5Pget_filter2(storage, unsigned(i), &flags, &n_values, values, sizeof name, name, nullptr);
    if (filter != H5Z_FILTER_DEFLATE && filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_FLETCHER32)
      refuse(fmt::format(
          "the table '{}' uses filter {}; only deflate (1), shuffle (2) and fletcher32 (3) are supported",
          path, filter));
  }
}

// Checks where the values are stored and that they fit into the file.
void Reader::check_storage(const std::string& path, const Dataset& table) const {
  const Handle storage(H5Dget_create_plist(table.id), H5Pclose);
  if (storage < 0) refuse(fmt::format("the storage of the table '{}' is damaged ({})", path, reason()));
  if (H5Pget_external_count(storage) != 0)
    refuse(fmt::format(
        "the values of the table '{}' are stored in another file; expected them in the file itself", path));
  const H5D_layout_t layout = H5Pget_layout(storage);
  if (layout != H5D_CONTIGUOUS && layout != H5D_COMPACT && layout != H5D_CHUNKED)
    refuse(fmt::format(
        "the table '{}' is composed of tables in other files; expected a table in the file itself", path));
  std::uint64_t most = bytes_;
  if (layout == H5D_CHUNKED) {
    check_filters(path, storage);
    hsize_t chunk[H5S_MAX_RANK] = {0};
    const int rank = H5Pget_chunk(storage, 4, chunk);
    std::uint64_t size = H5Tget_size(table.type);
    for (int d = 0; d < std::min(rank, 4); ++d) {
      if (chunk[d] == 0 || chunk[d] > most_expansion / size) size = most_expansion + 1;
      size = size > most_expansion ? size : size * chunk[d];
    }
    if (rank < 1 || size > most_expansion)
      refuse(fmt::format("the table '{}' has chunks of more than {} MB", path, most_expansion >> 20));
    most += most_expansion;
  } else if (H5Dget_storage_size(table.id) < table.bytes) {
    refuse(fmt::format("the table '{}' declares {} bytes of values, but {} are stored", path, table.bytes,
                       H5Dget_storage_size(table.id)));
  }
  if (table.bytes > most)
    refuse(
        fmt::format("the table '{}' declares {} bytes of values; a file of {} bytes can contain at most {}",
                    path, table.bytes, bytes_, most));
}

Reader::Dataset Reader::open(const std::string& path, Kind kind) const {
  Dataset table;
  table.id = object(path);
  const Quiet quiet;
  if (H5Iget_type(table.id) != H5I_DATASET)
    refuse(fmt::format("'{}' is a group or a type; expected a table", path));
  table.type = Handle(H5Dget_type(table.id), H5Tclose);
  table.space = Handle(H5Dget_space(table.id), H5Sclose);
  if (table.type < 0 || table.space < 0)
    refuse(fmt::format("cannot read the table '{}' ({})", path, reason()));
  const DataShape shape = shape_of(table.space);
  const bool right = is_integer(table.type) || (kind == Kind::numbers && is_real(table.type));
  if (!right || !shape.sound || shape.size.empty() || shape.size.size() > 2)
    refuse(fmt::format("the table '{}' contains {} ({}); expected one or two dimensions of {}", path,
                       shape.text(), name_of(table.type), kind == Kind::integers ? "integers" : "numbers"));
  table.rows = shape.size[0];
  table.is_flat = shape.size.size() == 1;
  if (!table.is_flat) table.width = shape.size[1];
  if (table.rows > largest_table || table.width > largest_table || table.rows * table.width > largest_table)
    refuse(fmt::format("the table '{}' contains {}; at most {} values are supported", path, shape.text(),
                       largest_table));
  table.bytes = table.rows * table.width * H5Tget_size(table.type);
  check_storage(path, table);
  return table;
}

Reader::Dataset Reader::open(const std::string& path, Kind kind, const RowSpan& rows) const {
  Dataset table = open(path, kind);
  if (table.rows != rows.total || table.width != rows.width)
    refuse(fmt::format("the table '{}' has {} rows of {} values; expected {} of {}", path, table.rows,
                       table.width, rows.total, rows.width));
  if (rows.first > rows.total || rows.count > rows.total - rows.first)
    refuse(fmt::format("rows {} to {} of the table '{}' requested, but it has {}", rows.first,
                       rows.first + rows.count, path, table.rows));
  return table;
}

void Reader::read(const std::string& path, const Dataset& table, const RowSpan& rows, hid_t type,
                  void* values) const {
  if (rows.count == 0 || rows.width == 0) return;
  const Quiet quiet;
  const hsize_t start[2] = {rows.first, 0}, count[2] = {rows.count, rows.width},
                size[1] = {rows.count * rows.width};
  const Handle memory(H5Screate_simple(1, size, nullptr), H5Sclose);
  // The number of dimensions is 1 or 2, as checked before.
  if (H5Sselect_hyperslab(table.space, H5S_SELECT_SET, start, nullptr, count, nullptr) < 0 ||
      H5Dread(table.id, type, memory, table.space, H5P_DEFAULT, values) < 0)
    refuse(fmt::format("cannot read the table '{}' ({})", path, reason()));
}

std::uint64_t Reader::rows(const std::string& path, std::uint64_t width) const {
  const Dataset table = open(path, Kind::numbers);
  if (table.width != width)
    refuse(fmt::format("the table '{}' has {} values per row; expected {}", path, table.width, width));
  return table.rows;
}

void Reader::read(const std::string& path, const RowSpan& rows, double* values) const {
  read(path, open(path, Kind::numbers, rows), rows, H5T_NATIVE_DOUBLE, values);
}

void Reader::read(const std::string& path, const RowSpan& rows, std::int64_t* values) const {
  read(path, open(path, Kind::integers, rows), rows, H5T_NATIVE_INT64, values);
}

std::vector<double> Reader::table(const std::string& path, std::uint64_t n, std::uint64_t width) const {
  const RowSpan rows{0, n, n, width};
  const Dataset table = open(path, Kind::numbers, rows);
  std::vector<double> values(n * width);
  read(path, table, rows, H5T_NATIVE_DOUBLE, values.data());
  return values;
}

std::vector<std::string> Reader::members(const std::string& group, std::size_t most) const {
  std::vector<std::string> names;
  if (!has(group)) return names;
  const Handle place = object(group);
  const Quiet quiet;
  if (H5Iget_type(place) != H5I_GROUP)
    refuse(fmt::format("'{}' is a table or a type; expected a group", group));
  struct List {
    std::vector<std::string>& names;
    std::size_t most;
  } list{names, most};
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    List& l = *static_cast<List*>(data);
    if (l.names.size() == l.most) return -1;
    l.names.emplace_back(name);
    return 0;
  };
  if (H5Literate(place, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &list) < 0)
    refuse(fmt::format("cannot list the group '{}', or it has more than {} members", group, most));
  return names;
}

void Reader::add_leaves(const std::string& group, const std::string& below, std::size_t& left,
                        std::vector<std::string>& to) const {
  for (const std::string& name : members(group + below, left)) {
    if (left-- == 0) refuse(fmt::format("the group '{}' has too many members, or contains itself", group));
    const std::string path = below + "/" + name;
    const Handle member = object(group + path);
    if (H5Iget_type(member) == H5I_GROUP)
      add_leaves(group, path, left, to);
    else
      to.push_back(path.substr(1));
  }
}

std::vector<std::string> Reader::leaves(const std::string& group, std::size_t most) const {
  std::vector<std::string> all;
  add_leaves(group, "", most, all);
  return all;
}

}  // namespace couplet::io::hdf5
