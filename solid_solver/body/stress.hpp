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

/// Von Mises stress [Pa].
double equivalent_stress(const Tensor3& stress);
/// Principal stresses in descending order [Pa].
std::array<double, 3> principal_stresses(const Tensor3& stress);

/// Interpolates symmetric tensors from cells and boundary faces to points, exact for linear fields. Uses the
/// vertex interpolation of the displacement with all boundary faces. At symmetry planes it averages in the
/// mirrored tensor, so that there is no shear. At material interfaces it takes the mean.
class PointTensors {
 public:
  /// `is_symmetry`: one flag per patch. `inside`: any interpolation, kept by reference. Collective.
  PointTensors(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const std::vector<bool>& is_symmetry,
               const fv::VertexInterpolation& inside);
  /// `cells`: per owned cell; `faces`: per boundary face of owned cells. Returns packed values at all local
  /// points. Collective.
  std::vector<double> interpolate(std::span<const Tensor3> cells, std::span<const Tensor3> faces) const;
  /// Interpolates tensors that are not symmetric.
  std::vector<Tensor3> interpolate_full(std::span<const Tensor3> cells, std::span<const Tensor3> faces) const;

 private:
  /// `get(i)`, `set(i, tensor)`: access to the points of symmetry planes.
  template <class Get, class Set>
  void mirror(const Get& get, const Set& set) const;
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
