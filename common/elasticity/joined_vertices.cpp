// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/joined_vertices.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::elastic {
namespace {

constexpr int stride = ElasticNodes::stride;
// Tolerance for entries of F_V (0 to 1) at the copies of a point.
constexpr double alike = 1e-6;

// Layout of exchanged VertexSums: m, s, sum of 1/d, number of nodes, number of copies in Mesh::wide_points.
constexpr int sums_stride = 15;
void put(const fv::VertexSums& sums, bool is_wide, double* to) {
  to = std::copy_n(sums.m.data(), 9, to);
  to = std::copy_n(sums.s.data(), 3, to);
  to[0] = sums.inverse_distance;
  to[1] = sums.count;
  to[2] = is_wide ? 1 : 0;
}
fv::VertexSums sums_at(const double* from) {
  fv::VertexSums sums;
  std::copy_n(from, 9, sums.m.data());
  std::copy_n(from + 9, 3, sums.s.data());
  sums.inverse_distance = from[12];
  sums.count = from[13];
  return sums;
}

// Layout of exchanged VertexWeightSums.
constexpr int weights_stride = 5;
void put(const fv::VertexWeightSums& sums, double* to) {
  to[0] = sums.sum;
  to[1] = sums.squares;
  std::copy_n(sums.miss.data(), 3, to + 2);
}

}  // namespace

JoinedVertices::JoinedVertices(const mesh::Mesh& mesh, const ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      periodic_(mesh, rows.geometry()),
      joined_(mesh.points.n_local(), 0) {
  refuse_unlike();
  for (const Index v : periodic_.points()) {
    joined_[v] = 1;
    if (v >= mesh.points.n_owned() || rows.constraints().is_fixed(v)) continue;
    points_.push_back(v);
    offset_.push_back(offset_.back() + std::ssize(rows.vertices().nodes(v)));
  }
  const JoinedWeights plain = weights(fv::VertexWeights::inverse_distance),
                      least = weights(fv::VertexWeights::least_squares);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    // The choice is the same as in VertexInterpolation.
    const bool is_plain = !plain.is_wide[i] && plain.magnification[i] <= mesh::longest_reach;
    const std::vector<double>& chosen = is_plain ? plain.weight : least.weight;
    weight_.insert(weight_.end(), chosen.begin() + offset_[i], chosen.begin() + offset_[i + 1]);
  }
}

/// Throws Error if only one side is constrained, because the scene is then not periodic.
void JoinedVertices::refuse_unlike() const {
  std::vector<double> free(std::size_t(mesh_.points.n_local()) * 9, 0.0);
  for (const Index v : periodic_.points())
    std::copy_n(rows_.constraints().free_part(v).data(), 9, free.data() + std::size_t(v) * 9);
  std::vector<double> sums = free;
  periodic_.add_up(sums, 9);
  std::vector<Vec3> unlike;
  for (std::size_t i = 0; i < periodic_.points().size(); ++i) {
    const Index v = periodic_.points()[i];
    if (v >= mesh_.points.n_owned()) continue;
    double off = 0;
    for (int a = 0; a < mesh_.dim; ++a)
      for (int b = 0; b < mesh_.dim; ++b) {
        const std::size_t at = std::size_t(v) * 9 + a * 3 + b;
        off = std::max(off, std::abs(free[at] - sums[at] / periodic_.copies(i)));
      }
    if (off > alike) unlike.push_back(geometry_.points[v]);
  }
  unlike = parallel::all_gather(mesh_.comm, unlike);
  if (unlike.empty()) return;
  const Vec3& x = unlike.front();
  throw Error(
      "The two sides of the periodic patches are supported differently: the adjacent patches at ({:.4g}, {:.4g}, {:.4g}) hold "
      "the point in directions other than those held at its periodic copy. Give both ends the same type.",
      x.x(), x.y(), x.z());
}

Vec3 JoinedVertices::from_node(Index point, Index node) const {
  const Index n_cells = mesh_.cells.n_local();
  return geometry_.points[point] - (node < n_cells
                                        ? geometry_.cell_centre[node]
                                        : geometry_.face_centre[mesh_.n_interior + node - n_cells]);
}

const Tensor3* JoinedVertices::within(Index point) const {
  return rows_.vertices().on_symmetry(point) ? &rows_.vertices().projector(point) : nullptr;
}

JoinedVertices::JoinedWeights JoinedVertices::weights(fv::VertexWeights kind) const {
  const std::size_t n = std::size_t(mesh_.points.n_local());
  std::vector<double> of_nodes(n * sums_stride, 0.0), of_weights(n * weights_stride, 0.0);
  for (const Index v : points_) {
    fv::VertexSums sums;
    for (const Index node : rows_.vertices().nodes(v)) sums.add(from_node(v, node), kind, within(v));
    put(sums, mesh_.is_wide(v), of_nodes.data() + std::size_t(v) * sums_stride);
  }
  periodic_.add_up(of_nodes, sums_stride);
  JoinedWeights result;
  for (const Index v : points_) {
    const Vec3 lambda = sums_at(of_nodes.data() + std::size_t(v) * sums_stride).lambda(mesh_.dim, within(v));
    fv::VertexWeightSums here;
    for (const Index node : rows_.vertices().nodes(v)) {
      const Vec3 from = from_node(v, node);
      result.weight.push_back(fv::vertex_weight(from, lambda, kind));
      here.add(result.weight.back(), from);
    }
    put(here, of_weights.data() + std::size_t(v) * weights_stride);
  }
  periodic_.add_up(of_weights, weights_stride);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Index v = points_[i];
    const fv::VertexSums nodes = sums_at(of_nodes.data() + std::size_t(v) * sums_stride);
    const double* whole = of_weights.data() + std::size_t(v) * weights_stride;
    const bool cancels = fv::VertexWeightSums{whole[0], whole[1], Vec3::Zero()}.cancels(nodes);
    const auto around = rows_.vertices().nodes(v);
    for (std::size_t k = 0; k < around.size(); ++k) {
      double& w = result.weight[std::size_t(offset_[i]) + k];
      w = cancels ? 1 / (from_node(v, around[k]).norm() * nodes.inverse_distance) : w / whole[0];
    }
    result.magnification.push_back(cancels ? 1 : nodes.count * whole[1] / (whole[0] * whole[0]));
    result.is_wide.push_back(of_nodes[std::size_t(v) * sums_stride + 14] > 0);
  }
  return result;
}

void JoinedVertices::interpolate(const double* nodes, std::span<double> points) const {
  for (const Index v : periodic_.points()) std::fill_n(points.data() + std::size_t(v) * stride, stride, 0.0);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto around = rows_.vertices().nodes(points_[i]);
    double* value = points.data() + std::size_t(points_[i]) * stride;
    for (std::size_t k = 0; k < around.size(); ++k)
      lanes::add<3>(value, weight_[std::size_t(offset_[i]) + k] *
                               lanes::load<3>(nodes + std::size_t(around[k]) * stride));
  }
  periodic_.add_up(points, stride);
}

void JoinedVertices::to_nodes(std::span<double> point_forces, double* node_forces) const {
  periodic_.add_up(point_forces, stride, mesh::PeriodicPoints::Ghosts::count);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto around = rows_.vertices().nodes(points_[i]);
    const lanes::Lane<3> force = lanes::load<3>(point_forces.data() + std::size_t(points_[i]) * stride);
    for (std::size_t k = 0; k < around.size(); ++k)
      lanes::add<3>(node_forces + std::size_t(around[k]) * stride,
                    weight_[std::size_t(offset_[i]) + k] * force);
  }
}

}  // namespace couplet::elastic
