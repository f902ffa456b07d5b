// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "common/io/cut/cut_mesh.hpp"
#include "common/io/hdf5_reader.hpp"

namespace couplet::io::cut {

constexpr int version = 1;
constexpr const char *version_name = "cut-mesh-version", *dimension_name = "dimension",
                     *edge_name = "shortest-edge";
constexpr const char *points_table = "points", *kind_table = "cells/kind", *first_table = "cells/first",
                     *cell_points_table = "cells/points", *element_points_table = "boundary/points",
                     *element_patch_table = "boundary/patch";
constexpr std::size_t longest_name = 256;  // of zones and patches

/// Points of a boundary element, -1 where it has fewer.
inline std::uint64_t element_width(int dim) { return dim == 2 ? 2 : 4; }

/// Sum over the values of a table, each mixed with its place, so that ranks may add up their rows.
template <class T>
std::uint64_t digest_of(std::span<const T> values, std::uint64_t first) {
  std::uint64_t sum = 0;
  for (const T& value : values) {
    std::uint64_t word = 0;
    static_assert(sizeof(T) == sizeof word);
    std::memcpy(&word, &value, sizeof word);
    word = (word ^ (++first * 0x9e3779b97f4a7c15ull)) * 0xff51afd7ed558ccdull;
    sum += (word ^ (word >> 32)) * 0xc4ceb9fe1a85ec53ull;
  }
  return sum;
}

}  // namespace couplet::io::cut
