// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elastic_rows.hpp"
#include "common/elasticity/elastic_vertices.hpp"
#include "common/elasticity/thesis/elastic_corrected_face.hpp"
#include "common/elasticity/thesis/elastic_corrections.hpp"

namespace couplet::elastic::corrected {

template <int D>
class CorrectedKernel final : public ElasticKernel::Implementation {
 public:
  CorrectedKernel(const mesh::Mesh& mesh, const ElasticOperator& rows);

  void apply(std::span<const double> unknowns, std::span<const double> known,
             std::span<double> result) override;
  void face_gradients(std::span<const double> unknowns, std::span<const double> known,
                      const ElasticKernel::TakeGradient& take, Index first, Index end) override;
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) override;

  [[gnu::always_inline]] inline void find_cell_gradients();
  [[gnu::always_inline]] inline void find_boundary_gradients();
  [[gnu::always_inline]] inline void find_vertices(std::span<const Index> points);
  [[gnu::always_inline]] inline void collect_forces(std::span<const double> known, std::span<double> result);

 private:
  void prepare(std::span<const double> unknowns, std::span<const double> known);
  void plain_vertices();
  void mirror_vertex_gradients();
  double* cell(Index node) { return records_.data() + std::size_t(node) * record<D>; }
  double* vertex(Index point) { return points_.data() + std::size_t(point) * record<D>; }
  [[gnu::always_inline]] inline Surface<D> around(Index f);
  [[gnu::always_inline]] inline Lane<D> inner(Index f, const Rows<D>& grad);
  [[gnu::always_inline]] inline Lane<D> outer(Index f, const Rows<D>& grad);
  [[gnu::always_inline]] inline Lane<D> at_symmetry(Index f, const Rows<D>& grad);
  template <class Take>
  [[gnu::always_inline]] inline void set_record(Index node, const Vec3& place, const Take& row);

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const ElasticOperator& rows_;
  ElasticNodes<D> nodes_;
  ElasticRows boundary_;
  ElasticVertices vertices_;
  CellGradients gradients_;
  std::vector<Index> open_points_, open_faces_;  // of traction faces; faces include the ghosts
  std::vector<Index> plain_points_;              // whose value takes nothing from the gradients
  std::vector<MirrorVertex> mirrors_;
  FaceLames lame_;
  std::vector<CorrectedFace> faces_;
  Vec3 origin_ = Vec3::Zero();
  // q = u - 1/2 x . G and G of the nodes; u and G of the vertices: sum w (u_i + 1/2 r_i . G_i) is then
  // sum w q_i + 1/2 x_V . sum w G_i.
  std::vector<double> records_, points_;
};

}  // namespace couplet::elastic::corrected
