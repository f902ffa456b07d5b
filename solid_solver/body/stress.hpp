// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/fv/vertex_interpolation.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::solid {

/// Symmetric tensors are packed as xx, yy, zz, xy, yz, xz.
constexpr int tensor_size = 6;
using PackedTensor = std::array<double, tensor_size>;
constexpr std::array<const char*, tensor_size> tensor_component{"xx", "yy", "zz", "xy", "yz", "xz"};
PackedTensor pack(const Tensor3& tensor);
Tensor3 unpack(std::span<const double> packed);

/// Materials are 0 to one less than this. Collective.
int number_of_materials(const mesh::Mesh& mesh);

/// von Mises [Pa].
double equivalent_stress(const Tensor3& stress);
/// Principal stresses in descending order [Pa].
std::array<double, 3> principal_stresses(const Tensor3& stress);

/// Packed tensors of all local points, one entry per material: stress and strain jump where materials meet, and a point of the
/// joint has the value of each side. NaN where a point has no cell of the material.
using SidedTensors = std::vector<std::vector<double>>;
/// One tensor per point: at a joint that of the side with the larger equivalent value.
std::vector<double> worst_side(SidedTensors sides);

/// Symmetric tensors at points from those in cells and on boundary faces, exact for linear fields (the vertex interpolation of the
/// displacement, all faces of the boundary taking part). At symmetry planes the mirrored tensor is averaged in: no shear there.
class PointTensors {
 public:
  /// `is_symmetry`: one flag per patch. `inside`: any interpolation, kept by reference. Collective.
  PointTensors(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const std::vector<bool>& is_symmetry,
               const fv::VertexInterpolation& inside);
  /// `cells`: tensors of owned cells; `faces`: tensors of boundary faces of owned cells. Collective.
  SidedTensors interpolate(std::span<const Tensor3> cells, std::span<const Tensor3> faces) const;

 private:
  Vec<tensor_size> side_of(Index point, int material, std::span<const double> cells,
                           std::span<const double> faces) const;
  struct Mirror {
    Tensor3 reflection;  // I - 2 n n
    std::vector<Index> points;
  };
  const mesh::Mesh* mesh_;
  const fv::VertexInterpolation& row_of(Index point) const {
    return surface_.nodes(point).empty() ? *inside_ : surface_;
  }
  const fv::VertexInterpolation* inside_;
  fv::VertexInterpolation surface_;
  std::vector<Mirror> mirrors_;
};

}  // namespace couplet::solid
