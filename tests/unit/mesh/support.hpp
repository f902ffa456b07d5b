// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/mesh/load.hpp"
#include "tests/support/test.hpp"

namespace couplet::test {

struct Box {
  const char* name;
  mesh::BoxCells cells;
};

inline const std::vector<Box>& boxes() {
  static const std::vector<Box> all{{"quadrilaterals", mesh::BoxCells::quadrilaterals},
                                    {"triangles", mesh::BoxCells::triangles},
                                    {"hexahedra", mesh::BoxCells::hexahedra},
                                    {"tetrahedra", mesh::BoxCells::tetrahedra},
                                    {"prisms", mesh::BoxCells::prisms},
                                    {"mixed", mesh::BoxCells::mixed}};
  return all;
}

inline const Vec3 lower(1, -2, 0.5), upper(3, 1, 1.5);

/// A distorted box of 4 x 5 x 3 grid cells between `lower` and `upper`.
inline mesh::RawMesh distorted_box(mesh::BoxCells cells) {
  mesh::RawMesh raw = mesh::make_box(cells, {4, 5, 3}, lower, upper);
  mesh::perturb_interior(raw, 0.2, 7);
  return raw;
}

inline double box_volume(int dim) {
  const Vec3 size = upper - lower;
  return dim == 2 ? size[0] * size[1] : size.prod();
}

inline const std::filesystem::path data = TEST_DATA;

/// A folder of this process that goes away at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() { std::filesystem::create_directories(path); }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name) << text;
    return path / name;
  }
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("couplet-test-mesh-" + std::to_string(getpid()));
};

}  // namespace couplet::test
