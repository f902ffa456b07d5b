// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/fv/elastic_kernel.hpp"
#include "common/fv/lanes.hpp"

namespace couplet {

class ElasticKernel::Implementation {
 public:
  virtual ~Implementation() = default;
  virtual void apply(std::span<const double> unknowns, std::span<const double> known,
                     std::span<double> result) = 0;
  virtual void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                              std::span<Tensor3> gradients) = 0;
  virtual void point_values(std::span<const double> unknowns, std::span<const double> known,
                            std::span<double> points) = 0;
};

std::unique_ptr<ElasticKernel::Implementation> make_thesis_kernel(const Mesh& mesh,
                                                                  const ElasticOperator& rows,
                                                                  std::span<const double> mu,
                                                                  std::span<const double> lambda);
std::unique_ptr<ElasticKernel::Implementation> make_corrected_kernel(const Mesh& mesh,
                                                                     const ElasticOperator& rows,
                                                                     std::span<const double> mu,
                                                                     std::span<const double> lambda);

/// Displacements of all nodes (local cells, then boundary faces) padded to whole lanes, and back. A symmetry
/// face is a node of value zero.
template <int D>
class ElasticNodes {
 public:
  static constexpr int stride = lanes::width<D>;

  ElasticNodes(const Mesh& mesh, const ElasticOperator& rows)
      : mesh_(&mesh),
        rows_(&rows),
        value_(std::size_t(mesh.cells.n_local() + mesh.boundary.n_local()) * stride, 0.0),
        force_(std::size_t(mesh.cells.n_local()) * stride, 0.0) {}

  const double* operator[](Index node) const { return value_.data() + std::size_t(node) * stride; }
  double* force(Index cell) { return force_.data() + std::size_t(cell) * stride; }
  void clear_forces() { std::fill(force_.begin(), force_.end(), 0.0); }

  /// Node values of all local nodes. Collective.
  void fill(std::span<const double> unknowns, std::span<const double> known) {
    const Index n_owned = mesh_->cells.n_owned(), n_cells = mesh_->cells.n_local();
    for (Index c = 0; c < n_owned; ++c) copy(unknowns.data() + std::size_t(c) * D, at(c));
    const auto& open = rows_->traction_faces();
    for (std::size_t i = 0; i < open.size(); ++i)
      copy(unknowns.data() + (n_owned + i) * D, at(n_cells + open[i] - mesh_->n_interior));
    for (const Index f : rows_->prescribed_faces()) {
      double* here = at(n_cells + f - mesh_->n_interior);
      if (known.empty())
        std::fill_n(here, D, 0.0);
      else
        copy(known.data() + std::size_t(rows_->known_of_face(f)) * D, here);
    }
    const std::span<double> all(value_);
    mesh_->cells.update_ghosts(all.first(std::size_t(n_cells) * stride), stride);
    mesh_->boundary.update_ghosts(all.subspan(std::size_t(n_cells) * stride), stride);
  }

  /// The rows of the owned cells from the forces collected.
  void take_forces(std::span<double> result) const {
    for (Index c = 0; c < mesh_->cells.n_owned(); ++c)
      copy(force_.data() + std::size_t(c) * stride, result.data() + std::size_t(c) * D);
  }

 private:
  double* at(Index node) { return value_.data() + std::size_t(node) * stride; }
  static void copy(const double* from, double* to) {
    for (int a = 0; a < D; ++a) to[a] = from[a];
  }

  const Mesh* mesh_;
  const ElasticOperator* rows_;
  std::vector<double> value_, force_;
};

/// Flux faces by what happens to their force: into both cells, the owner, the owner across the plane only, or
/// the face's own row.
struct FaceKinds {
  Index n_interior = 0;
  std::vector<Index> prescribed, symmetry, traction;  ///< traction: in the order of the rows
  FaceKinds(const Mesh& mesh, const ElasticOperator& rows)
      : n_interior(mesh.n_interior), traction(rows.traction_faces()) {
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
      if (rows.condition(f) == ElasticCondition::prescribed) prescribed.push_back(f);
      if (rows.condition(f) == ElasticCondition::symmetry) symmetry.push_back(f);
    }
  }
};

}  // namespace couplet
