// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

class ElasticKernel::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual void apply(std::span<const double> unknowns, std::span<const double> known,
                     std::span<double> result) = 0;
  virtual void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                              const TakeGradient& take, Index first, Index end) = 0;
  virtual void point_values(std::span<const double> unknowns, std::span<const double> known,
                            std::span<double> points) = 0;
  // Of the symmetric kernel alone, see ElasticKernel.
  virtual bool set_density(std::span<const double> /*of_cells*/) { return false; }
  virtual void apply_with_mass(std::span<const double> /*unknowns*/, std::span<const double> /*known*/,
                               double /*mass_factor*/, bool /*with_stiffness*/,
                               std::span<double> /*result*/) {}
  virtual double product(ElasticPart /*part*/, const ElasticField& /*force*/,
                         const ElasticField& /*motion*/) {
    return 0;
  }
  virtual Vec3 add_face_forces(std::span<const double> /*forces*/, std::span<double> /*rhs*/) {
    return Vec3::Zero();
  }
  virtual void face_means(std::span<const Index> /*faces*/, std::span<const double> /*unknowns*/,
                          std::span<const double> /*known*/, std::span<double> /*means*/) {}
  virtual void add_cell_forces(std::span<const double> /*forces*/, std::span<double> /*rhs*/) {}
  virtual void add_pressure(std::span<const double> /*pressure*/, std::span<double> /*rhs*/) {}
  virtual std::vector<Wrench> holding_forces(std::span<const double> /*unknowns*/,
                                             std::span<const double> /*known*/,
                                             const ElasticLoads& /*loads*/) {
    return {};
  }
  virtual void apply_mixed(std::span<const double> /*unknowns*/, std::span<const double> /*pressure*/,
                           double /*mass_factor*/, std::span<double> /*result*/,
                           std::span<double> /*defect*/) {}
};

std::unique_ptr<ElasticKernel::Implementation> make_thesis_kernel(const mesh::Mesh& mesh,
                                                                  const ElasticOperator& rows);
std::unique_ptr<ElasticKernel::Implementation> make_corrected_kernel(const mesh::Mesh& mesh,
                                                                     const ElasticOperator& rows);
std::unique_ptr<ElasticKernel::Implementation> make_symmetric_kernel(const mesh::Mesh& mesh,
                                                                     const ElasticOperator& rows);
std::unique_ptr<ElasticKernel::Implementation> make_axisymmetric_kernel(const mesh::Mesh& mesh,
                                                                        const ElasticOperator& rows);

/// Lame's constants of a face: the owner's where cells have their own, the mean of both across an interior
/// face.
inline LameConstants face_lame(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const LameConstants here = rows.lame(mesh.owner[f]);
  if (f >= mesh.n_interior) return here;
  const LameConstants there = rows.lame(mesh.neighbour[f]);
  return {0.5 * (here.mu + there.mu), 0.5 * (here.lambda + there.lambda)};
}

/// The same of the elastic matrix, where the body has one.
inline ElasticMatrix face_matrix(const mesh::Mesh& mesh, const ElasticOperator& rows, Index f) {
  const ElasticMatrix& here = rows.elastic_matrix(mesh.owner[f]);
  if (f >= mesh.n_interior) return here;
  return 0.5 * (here + rows.elastic_matrix(mesh.neighbour[f]));
}

/// Faces whose force is asked for: the flux faces, and with bonded faces those of ghosts too, since the row
/// of a bonded face holds the force on its other side.
inline Index n_faces_with_force(const mesh::Mesh& mesh) {
  return mesh.twin.empty() ? mesh.n_flux_faces() : mesh.n_faces();
}

/// face_lame() of all faces with a force; one pair where all are alike.
class FaceLames {
 public:
  FaceLames(const mesh::Mesh& mesh, const ElasticOperator& rows) : varies_(rows.is_uniform() ? 0 : 1) {
    const Index n = varies_ ? n_faces_with_force(mesh) : 1;
    for (Index f = 0; f < n; ++f) value_.push_back(varies_ ? face_lame(mesh, rows, f) : rows.lame(0));
  }
  const LameConstants& operator[](Index f) const { return value_[std::size_t(f) * varies_]; }

 private:
  std::size_t varies_;
  std::vector<LameConstants> value_;
};

/// Displacements of all nodes (local cells, then boundary faces) padded to whole lanes, and the forces on the
/// cells. A symmetry face is a node of value zero.
template <int D>
class ElasticNodes {
 public:
  static constexpr int stride = lanes::width<D>;

  ElasticNodes(const mesh::Mesh& mesh, const ElasticOperator& rows)
      : mesh_(&mesh),
        rows_(&rows),
        value_(std::size_t(mesh.cells.n_local() + mesh.boundary.n_local()) * stride, 0.0) {}

  const double* operator[](Index node) const { return value_.data() + std::size_t(node) * stride; }
  double* value(Index node) { return at(node); }
  const double* of_face(Index face) const {
    return (*this)[mesh_->cells.n_local() + face - mesh_->n_interior];
  }
  double* force(Index cell) { return force_.data() + std::size_t(cell) * stride; }
  /// First of all that touches forces: who asks for gradients alone has none.
  void clear_forces() { force_.assign(std::size_t(mesh_->cells.n_local()) * stride, 0.0); }

  /// Node values of all local nodes. `supports_hold`: supports have their known components, whatever the
  /// unknowns say. Collective.
  void fill(std::span<const double> unknowns, std::span<const double> known, bool supports_hold = false) {
    const Index n_owned = mesh_->cells.n_owned(), n_cells = mesh_->cells.n_local();
    for (Index c = 0; c < n_owned; ++c) copy(unknowns.data() + std::size_t(c) * D, at(c));
    const auto& open = rows_->unknown_faces();
    for (std::size_t i = 0; i < open.size(); ++i)
      copy(unknowns.data() + (n_owned + i) * D, at(n_cells + open[i] - mesh_->n_interior));
    for (const Index f : rows_->known_faces()) {
      if (!rows_->at(f).fixed) {
        if (supports_hold) hold(f, known);
        continue;
      }
      double* here = at(n_cells + f - mesh_->n_interior);
      if (known.empty())
        std::fill_n(here, D, 0.0);
      else
        copy(known.data() + std::size_t(rows_->known_of_face(f)) * D, here);
    }
    const std::span<double> all(value_);
    mesh_->cells.update_ghosts(all.first(std::size_t(n_cells) * stride), stride);
    mesh_->boundary.update_ghosts(all.subspan(std::size_t(n_cells) * stride), stride);
    for (std::size_t b = 0; b < mesh_->twin.size(); ++b) {
      const Index first = mesh_->twin[b];
      if (first < 0 || mesh_->boundary_id[first] > mesh_->boundary_id[b]) continue;
      copy(at(n_cells + first), at(n_cells + static_cast<Index>(b)));
    }
  }

  /// The rows of the owned cells from the forces collected.
  void take_forces(std::span<double> result) const {
    for (Index c = 0; c < mesh_->cells.n_owned(); ++c)
      copy(force_.data() + std::size_t(c) * stride, result.data() + std::size_t(c) * D);
  }

 private:
  void hold(Index f, std::span<const double> known) {
    double* here = at(mesh_->cells.n_local() + f - mesh_->n_interior);
    Vec3 gap = Vec3::Zero();
    for (int a = 0; a < D; ++a)
      gap[a] = (known.empty() ? 0 : known[std::size_t(rows_->known_of_face(f)) * D + a]) - here[a];
    const Vec3 step = rows_->at(f).known * gap;
    for (int a = 0; a < D; ++a) here[a] += step[a];
  }
  double* at(Index node) { return value_.data() + std::size_t(node) * stride; }
  static void copy(const double* from, double* to) {
    for (int a = 0; a < D; ++a) to[a] = from[a];
  }

  const mesh::Mesh* mesh_;
  const ElasticOperator* rows_;
  std::vector<double> value_, force_;
};

}  // namespace couplet::elastic
