// SPDX-License-Identifier: Apache-2.0
// All numbers of a checkpoint file by the path of their table, read with nothing but HDF5: what a participant
// saved, whatever it calls it.
#pragma once

#include <hdf5.h>

#include "tests/support/test.hpp"

namespace couplet::contract {
using Contents = std::map<std::string, std::vector<double>>;

inline Contents contents(const std::filesystem::path& file) {
  Contents all;
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto visit = [](hid_t place, const char* name, const H5L_info_t*, void* data) -> herr_t {
    const hid_t table = H5Oopen(place, name, H5P_DEFAULT);
    if (H5Iget_type(table) != H5I_DATASET) return H5Oclose(table);
    const hid_t space = H5Dget_space(table);
    std::vector<double>& values = (*static_cast<Contents*>(data))[name];
    values.resize(std::size_t(H5Sget_simple_extent_npoints(space)));
    H5Dread(table, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Sclose(space);
    H5Dclose(table);
    return 0;
  };
  H5Lvisit(id, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &all);
  H5Fclose(id);
  return all;
}

/// Largest difference of two files over the largest value of the table; infinity if they hold other tables.
/// Checksums count only where the values must be the same to the bit, and so do copies that differ from their owners.
inline double apart(const Contents& a, const Contents& b) {
  const auto by_bits = [](const std::string& name) {
    return name.starts_with("layout") || name.starts_with("checks") || name.starts_with("arrays/copies");
  };
  if (a.empty()) return INFINITY;
  for (const auto& [name, values] : b)
    if (!by_bits(name) && !a.contains(name)) return INFINITY;
  double worst = 0;
  for (const auto& [name, values] : a) {
    if (by_bits(name)) continue;
    const auto found = b.find(name);
    if (found == b.end() || found->second.size() != values.size()) return INFINITY;
    double off = 0, largest = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      off = std::max(off, std::abs(values[i] - found->second[i]));
      largest = std::max(largest, std::abs(values[i]));
      if (std::isnan(values[i]) != std::isnan(found->second[i])) return INFINITY;
    }
    worst = std::max(worst, largest > 0 ? off / largest : off);
  }
  return worst;
}

}  // namespace couplet::contract
