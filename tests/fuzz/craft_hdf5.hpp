// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz {

/// One value of a file of HDF5 as it is to be written, sound or not.
struct CraftedValue {
  enum class Type {
    f64,
    f32,
    i64,
    u8,
    big_endian,
    text,
    long_text,
    text_of_any_length,
    compound,
    array,
    reference,
    enumeration,
    opaque,
    odd_float,
    none
  };
  enum class Store {
    plain,
    compact,
    chunked,
    deflated,
    bomb,
    unwritten,
    unknown_filter,
    other_file,
    virtual_table
  };
  enum class Link { hard, soft, soft_loop, external, missing, group, cycle, twice };
  std::string path;  ///< "mass" or "surface/vertices"
  bool is_attribute = false;
  Type type = Type::f64;
  std::vector<std::uint64_t> size{};     ///< {}: one value
  std::vector<double> values{};          ///< what is not there is 0
  std::vector<std::int64_t> integers{};  ///< in place of values, of an i64
  std::string text{};
  Store store = Store::plain;
  Link link = Link::hard;
};

/// What a file holds, and writing it.
using CraftedFile = std::vector<CraftedValue>;
void write(const std::filesystem::path& file, const CraftedFile& content);

/// One to three of its values changed: rank, type, size, storage, link, numbers; or it begins to lack one.
CraftedFile mutate(CraftedFile content, Dice& dice);

/// Some bytes of the file's own structure overwritten, or its end cut off.
void damage_bytes(const std::filesystem::path& file, Dice& dice);

}  // namespace couplet::fuzz
