// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <string>
#include <vector>

namespace couplet::io::hdf5 {

/// One of the standard types of numbers, of either order of bytes; all others are refused.
bool is_integer(hid_t type);
bool is_real(hid_t type);
/// For messages: "float64", "text of 14 bytes", "a compound type".
std::string name_of(hid_t type);

/// Dimensions of a dataspace: none of a single value. Not sound: an empty one, or one of more than four.
struct Shape {
  bool sound = false;
  std::vector<std::uint64_t> size;
  std::string text() const;
  bool is_one_value() const;
};
Shape shape_of(hid_t space);

}  // namespace couplet::io::hdf5
