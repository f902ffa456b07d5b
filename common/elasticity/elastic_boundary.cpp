// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/elastic_boundary.hpp"

namespace couplet::elastic {

BoundaryRow free_row() { return {}; }

BoundaryRow fixed_row() { return support_row(Tensor3::Identity(), Tensor3::Zero()); }

BoundaryRow support_row(const Tensor3& known, const Tensor3& spring) {
  BoundaryRow row;
  row.known = row.passing = known;
  row.spring = spring;
  row.fixed = known == Tensor3::Identity();
  row.held = !known.isZero(0);
  return row;
}

BoundaryRow mirror_row() {
  BoundaryRow row;
  row.held = row.mirrored = true;
  return row;
}

BoundaryRow level_row() {
  BoundaryRow row;
  row.passing = Tensor3::Identity();
  row.level = true;
  return row;
}

void ElasticBoundary::add(const BoundaryRow& row) {
  if (rows_.empty() || !(rows_.back() == row)) rows_.push_back(row);
  row_of_face_.push_back(static_cast<Index>(rows_.size()) - 1);
}

ElasticBoundary ElasticBoundary::on(const mesh::Mesh& mesh, const mesh::Geometry& geometry) const {
  ElasticBoundary result;
  const std::vector<Index> patch_of = mesh.patch_of_boundary();
  for (Index b = 0; b < size(); ++b) {
    BoundaryRow row = (*this)[b];
    if (mesh.patches[patch_of[b]].bonded) {
      row = {};
      row.passing = Tensor3::Identity();
      row.shared = true;
    }
    if (row.mirrored) {
      const Vec3 n = geometry.face_area[mesh.n_interior + b].normalized();
      row.known = row.passing = n * n.transpose();
    }
    result.add(row);
  }
  return result;
}

ElasticBoundary boundary_of_patches(const mesh::Mesh& mesh, std::span<const BoundaryRow> of_patches) {
  ElasticBoundary boundary;
  for (const Index p : mesh.patch_of_boundary()) boundary.add(of_patches[p]);
  return boundary;
}

}  // namespace couplet::elastic
