// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"

namespace couplet::elastic {

/// Rows of ElasticOperator for forces on the boundary faces of owned cells.
class ElasticRows {
 public:
  ElasticRows(const mesh::Mesh& mesh, const ElasticOperator& rows)
      : mesh_(&mesh), geometry_(&rows.geometry()), rows_(&rows) {
    const mesh::Geometry& geometry = rows.geometry();
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
      const BoundaryRow& here = rows.at(f);
      if (here.mirrored) symmetry_.push_back({f, geometry.face_area[f].normalized()});
      if (here.fixed || here.shared || here.level) held_.push_back(f);
    }
    for (const Index f : rows.unknown_faces()) {
      const LameConstants lame = rows.lame(mesh.owner[f]);
      const fv::FaceLine line = fv::face_line(mesh, geometry, f);
      stiffness_.push_back((2 * lame.mu + lame.lambda) * line.area * line.inverse_dn);
    }
  }

  /// Adds the forces to the cells and writes the rows of unknown faces. `force(f)` is sigma . S, `slope(f)`
  /// is n . grad u.
  template <int D, class Force, class Slope>
  [[gnu::always_inline]] inline void add_rows(ElasticNodes& nodes, std::span<const double> known, double* row,
                                              const Force& force, const Slope& slope) const {
    for (const Index f : held_) lanes::add<D>(nodes.force(mesh_->owner[f]), -force(f));
    for (const auto& [f, normal] : symmetry_) {
      lanes::Lane<D> n{};
      for (int a = 0; a < D; ++a) n[a] = normal[a];
      lanes::add<D>(nodes.force(mesh_->owner[f]), -lanes::dot<D>(n, force(f)) * n);  // no shear
    }
    const auto& unknown = rows_->unknown_faces();
    for (std::size_t i = 0; i < unknown.size(); ++i) {
      const Index f = unknown[i];
      lanes::Lane<D> own = {};
      if (rows_->known_of_face(f) >= 0) {
        std::array<double, lanes::width<D>> here{};
        lanes::store<D>(here.data(), force(f));
        hold<D>(f, stiffness_[i], nodes, known, here);
        own = lanes::load<D>(here.data());
      } else if (rows_->at(f).level) {
        const LameConstants lame = rows_->lame(mesh_->owner[f]);
        own = (2 * lame.mu + lame.lambda) * geometry_->face_area[f].norm() * slope(f);
      } else {
        own = force(f);
        if (rows_->at(f).shared) own += force(mesh_->n_interior + mesh_->twin[f - mesh_->n_interior]);
      }
      for (int a = 0; a < D; ++a) *row++ = own[a];
    }
  }

 private:
  /// Replaces the force on the face by its row. The signature avoids lanes, because passing them depends on
  /// the processor.
  template <int D, std::size_t Width>
  void hold(Index f, double stiffness, ElasticNodes& nodes, std::span<const double> known,
            std::array<double, Width>& force) const {
    const BoundaryRow& boundary = rows_->at(f);
    const double area = geometry_->face_area[f].norm();
    Vec3 jump = Vec3::Zero(), flux = Vec3::Zero();
    for (int a = 0; a < D; ++a) {
      jump[a] =
          nodes.of_face(f)[a] - (known.empty() ? 0 : known[std::size_t(rows_->known_of_face(f)) * D + a]);
      flux[a] = force[a];
    }
    const Vec3 pull = area * (boundary.spring * jump);
    const Vec3 spring = pull - boundary.known * pull;
    const Vec3 across = boundary.known * flux;
    const Vec3 own = flux - across + spring + stiffness * (boundary.known * jump);
    double* cell = nodes.force(mesh_->owner[f]);
    for (int a = 0; a < D; ++a) {
      cell[a] += spring[a] - across[a];
      force[a] = own[a];
    }
  }

  const mesh::Mesh* mesh_;
  const mesh::Geometry* geometry_;
  const ElasticOperator* rows_;
  std::vector<std::pair<Index, Vec3>> symmetry_;  // faces with normals
  std::vector<Index> held_;                       // faces whose whole force acts on the cell
  std::vector<double> stiffness_;                 // (2 mu + lambda) S / (d . n) of the unknown faces
};

}  // namespace couplet::elastic
