// SPDX-License-Identifier: Apache-2.0
#include "common/io/hdf5_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "common/base/text.hpp"

namespace couplet::io::hdf5 {
namespace {

struct Named {
  hid_t type;
  const char* name;
};

std::array<Named, 16> integer_types() {
  return {{{H5T_STD_I8LE, "int8"},
           {H5T_STD_I8BE, "int8"},
           {H5T_STD_U8LE, "uint8"},
           {H5T_STD_U8BE, "uint8"},
           {H5T_STD_I16LE, "int16"},
           {H5T_STD_I16BE, "int16"},
           {H5T_STD_U16LE, "uint16"},
           {H5T_STD_U16BE, "uint16"},
           {H5T_STD_I32LE, "int32"},
           {H5T_STD_I32BE, "int32"},
           {H5T_STD_U32LE, "uint32"},
           {H5T_STD_U32BE, "uint32"},
           {H5T_STD_I64LE, "int64"},
           {H5T_STD_I64BE, "int64"},
           {H5T_STD_U64LE, "uint64"},
           {H5T_STD_U64BE, "uint64"}}};
}

std::array<Named, 4> real_types() {
  return {{{H5T_IEEE_F64LE, "float64"},
           {H5T_IEEE_F64BE, "float64"},
           {H5T_IEEE_F32LE, "float32"},
           {H5T_IEEE_F32BE, "float32"}}};
}

template <class List>
const char* name_in(const List& list, hid_t type) {
  for (const Named& named : list)
    if (H5Tequal(type, named.type) > 0) return named.name;
  return nullptr;
}

}  // namespace

bool is_integer(hid_t type) { return name_in(integer_types(), type) != nullptr; }

bool is_real(hid_t type) { return name_in(real_types(), type) != nullptr; }

std::string name_of(hid_t type) {
  if (const char* name = name_in(integer_types(), type)) return name;
  if (const char* name = name_in(real_types(), type)) return name;
  const std::size_t size = H5Tget_size(type);
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

std::string Shape::text() const {
  if (!sound) return "no values or too many dimensions";
  if (size.empty()) return "one value";
  std::vector<std::string> words;
  for (const std::uint64_t n : size) words.push_back(std::to_string(n));
  return base::join(words, " x ") + (size.size() == 1 ? " values" : " table");
}

bool Shape::is_one_value() const {
  return sound && std::ranges::all_of(size, [](std::uint64_t n) { return n == 1; });
}

Shape shape_of(hid_t space) {
  Shape shape;
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

}  // namespace couplet::io::hdf5
