// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/mesh/mesh.hpp"

/// Writes the XDMF 3 index of an HDF5 series as plain text. The file is replaced at each output.
namespace couplet::io::xdmf {

/// XDMF number of a cell type in a mixed topology, whose points are in VTK order.
std::int64_t cell_code(mesh::CellType type);
/// XDMF number of an edge on the surface of a 2-D mesh.
inline constexpr std::int64_t edge_code = 2;
/// Number of points of a cell with this code.
std::uint64_t points_of(std::int64_t code);

struct Field {
  std::string name, unit;
  bool on_cells = true;
  int components = 1;
  bool operator==(const Field&) const = default;
};

struct OutputTime {
  std::string group;  ///< where it is in the HDF5 file
  double time = 0;    ///< [s]
  std::shared_ptr<const std::vector<Field>> fields;
};

struct FieldIndex {
  std::string file;       ///< HDF5 file, relative to the index
  std::int64_t kind = 0;  ///< code of all cells; 0 if mixed
  std::uint64_t topology_size = 0, n_cells = 0, n_points = 0;
  bool moving = false;
  std::vector<OutputTime> entries;

  /// Adds an output. Its fields are kept once if they are those of the last one.
  void add(std::string group, double time, std::vector<Field> fields);
};

/// Replaces the index by a rename, so that a viewer never reads half of it.
void write(const std::filesystem::path& index, const FieldIndex& series);

}  // namespace couplet::io::xdmf
