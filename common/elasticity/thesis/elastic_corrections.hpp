// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/elasticity.hpp"
#include "common/elasticity/lanes.hpp"

namespace couplet::elastic {

/// Least-squares gradients of the owned cells over the nodes across the cell's faces,
///   G_P = M^-1 sum_i w_i d_i (u_i - u_P),   M = sum_i w_i d_i d_i^T,   w_i = 1 / |d_i|^3;
/// a symmetry plane gives the mirrored cell, u_mirror - u_P = -2 n (n . u_P).
struct CellGradients {
  std::vector<Index> offset{0}, node;          ///< nodes as in VertexInterpolation
  std::vector<float> weight;                   ///< w_i over the largest of the cell, as used in M
  std::vector<std::array<double, 6>> inverse;  ///< M^-1: xx, xy, xz, yy, yz, zz
  struct Mirror {
    Index cell;
    Vec3 weight, normal;  ///< M^-1 w d
  };
  std::vector<Mirror> mirrors;

  CellGradients(const mesh::Mesh& mesh, const ElasticOperator& rows);
};

/// Value used on an edge of a face (3-D): the middle on a quadrilateral, or the mean on a triangle (whose
/// mean gradient of a quadratic field is that at its center). No correction if a vertex is known or lies
/// between materials.
enum class EdgeKind : std::uint8_t { plain, middle, mean };
/// Kinds of the edges of faces with a force, two bits per edge. Edge i joins points i and i + 1.
std::vector<std::uint32_t> edge_kinds(const mesh::Mesh& mesh, const ElasticOperator& rows);

/// Selects points whose nodes are too far away to extrapolate gradients. Their weights would amplify gradient
/// errors, and the operator would lose its positive eigenvalues.
std::vector<Index> plain_points(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                const std::vector<Index>& points);

/// Point on symmetry planes with their distinct normals.
struct MirrorVertex {
  Index point;
  std::vector<Vec3> normals;
};
std::vector<MirrorVertex> mirror_vertices(const mesh::Mesh& mesh, const ElasticOperator& rows,
                                          const std::vector<Index>& points);

}  // namespace couplet::elastic

namespace couplet::elastic::least_squares {

using lanes::Lane;
using lanes::load;
using lanes::store;

/// Face data beyond the mesh. Its vectors are recomputed from the positions of points and cells, which is
/// cheaper than reading them.
struct CorrectedFace {
  double inverse_dn;     // [1/m]
  double inverse_area;   // [1/m^2], in 2-D [1/m]
  std::uint32_t edges;   // two bits per edge: its EdgeKind
  std::uint32_t curved;  // true if the cell gradients give the second derivative across it
};

// The gradient errors of a pyramid, or of two cells of different kind, differ too much to estimate the second
// derivative from their difference.
inline bool alike(const mesh::Mesh& mesh, Index f) {
  const mesh::CellType here = mesh.cell_type[mesh.owner[f]];
  return here == mesh.cell_type[mesh.neighbour[f]] && here != mesh::CellType::pyramid;
}

// Far off the line between the cells the correction exceeds the corrected difference, and the operator loses
// its positive eigenvalues (on tetrahedra of an isosurface). Stretched lines of cells stay below one half.
inline bool near_line(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  constexpr double farthest = 0.5;
  const Vec3 &from = geometry.cell_centre[mesh.owner[f]], &to = geometry.cell_centre[mesh.neighbour[f]];
  const double across = (to - from).dot(geometry.face_area[f].normalized());
  return (geometry.face_centre[f] - 0.5 * (from + to)).norm() <= farthest * across;
}

inline CorrectedFace make_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index f) {
  const fv::FaceLine line = fv::face_line(mesh, geometry, f);
  return {line.inverse_dn, 1 / line.area, 0,
          f < mesh.n_interior && alike(mesh, f) && near_line(mesh, geometry, f)};
}

/// Rows i of a gradient: d u / d x_i.
template <int D>
struct Rows {
  elastic::lanes::Lane<D> row[D] = {};
};

template <int D>
[[gnu::always_inline]] inline elastic::lanes::Lane<D> contract(const Vec3& v, const double* rows) {
  elastic::lanes::Lane<D> sum = v[0] * load<D>(rows);
  for (int i = 1; i < D; ++i) sum += v[i] * load<D>(rows + i * D);
  return sum;
}

/// Record of a displacement (or q) and the rows of the gradient, without padding. The last lane extends into
/// the next record.
template <int D>
constexpr int record = (D + 1) * D;
/// Number of doubles for n records.
template <int D>
constexpr std::size_t record_space(std::size_t n) {
  return n * record<D> + lanes::width<D> - D;
}
template <int D>
[[gnu::always_inline]] inline elastic::lanes::Lane<D> row_of(const double* record, int i) {
  return load<D>(record + (i + 1) * D);
}
template <int D>
[[gnu::always_inline]] inline void store_record(double* to, const elastic::lanes::Lane<D>& u,
                                                const Rows<D>& gradient) {
  store<D>(to, u);
  for (int i = 0; i + 1 < D; ++i) store<D>(to + (i + 1) * D, gradient.row[i]);
  lanes::store_components<D>(to + D * D, gradient.row[D - 1]);
}

/// Tangential part of a gradient at a face, its normal and area.
template <int D>
struct Surface {
  Rows<D> grad;
  elastic::lanes::Lane<D> n = {};  // out of the owner
  double area;
};

template <int D>
[[gnu::always_inline]] inline elastic::lanes::Lane<D> between(const Vec3& from, const Vec3& to) {
  elastic::lanes::Lane<D> d = {};
  for (int a = 0; a < D; ++a) d[a] = to[a] - from[a];
  return d;
}

/// T x n / |S| of the rows T_i = sum_e L_e,i w_e: the surface Gauss theorem with the edges' L_e.
[[gnu::always_inline]] inline Rows<3> turn(const Rows<3>& t, const elastic::lanes::Lane<3>& n) {
  Rows<3> result;
  result.row[0] = n[2] * t.row[1] - n[1] * t.row[2];
  result.row[1] = n[0] * t.row[2] - n[2] * t.row[0];
  result.row[2] = n[1] * t.row[0] - n[0] * t.row[1];
  return result;
}

/// grad_t u from `value(i, L)` on edge i (of vector L) of the face's `corners`, in 2-D at its two points. The
/// edges sum to zero, so the last one needs no vector. The third edge of a triangle replaces the fourth.
template <int D, class Value>
[[gnu::always_inline]] inline Surface<D> surface(const CorrectedFace& face, std::span<const Index> corners,
                                                 const Vec3* x, const Value& value) {
  Surface<D> result;
  if constexpr (D == 2) {
    const elastic::lanes::Lane<2> tangent = between<2>(x[corners[0]], x[corners[1]]) * face.inverse_area;
    const elastic::lanes::Lane<2> along = (value(1, tangent) - value(0, tangent)) * face.inverse_area;
    for (int i = 0; i < 2; ++i) result.grad.row[i] = tangent[i] * along;
    result.n = elastic::lanes::Lane<2>{tangent[1], -tangent[0]};
    result.area = 1 / face.inverse_area;
  } else {
    const bool is_triangle = corners.size() == 3;
    elastic::lanes::Lane<3> edge[4];
    for (int e = 0; e < 3; ++e)
      edge[e] = between<3>(x[corners[e]], x[corners[e == 2 && is_triangle ? 0 : e + 1]]);
    edge[3] = -(edge[0] + edge[1] + edge[2]);
    // Half the cross product of the diagonals, or of two sides of a triangle.
    const elastic::lanes::Lane<3> vector = 0.5 * lanes::cross(edge[0] + edge[1], edge[1] + edge[2]);
    const elastic::lanes::Lane<3> last = is_triangle ? value(2, edge[2]) : value(3, edge[3]);
    Rows<3> t;
    for (int e = 0; e < 3; ++e) {
      const elastic::lanes::Lane<3> w = value(e, edge[e]) - last;
      for (int i = 0; i < 3; ++i) t.row[i] += edge[e][i] * w;
    }
    result.n = vector * face.inverse_area;
    result.area = lanes::dot<3>(vector, result.n);
    result.grad = turn(t, result.n * face.inverse_area);
  }
  return result;
}

/// n . grad u from `along` = d . grad u at the face center: with k = n - d / (d . n) and grad_t across n,
/// g = along / (d . n) + k . grad_t u = (along - d . grad_t u) / (d . n).
template <int D>
[[gnu::always_inline]] inline elastic::lanes::Lane<D> normal_derivative(const CorrectedFace& face,
                                                                        const Vec3& d,
                                                                        const elastic::lanes::Lane<D>& along,
                                                                        const Rows<D>& grad) {
  elastic::lanes::Lane<D> rest = along;
  for (int i = 0; i < D; ++i) rest -= d[i] * grad.row[i];
  return rest * face.inverse_dn;
}

/// Force sigma . S for grad u = n g + grad_t u, as in the kernel of the thesis.
template <int D>
[[gnu::always_inline]] inline elastic::lanes::Lane<D> force_on(const LameConstants& lame,
                                                               const elastic::lanes::Lane<D>& g,
                                                               const Surface<D>& surface) {
  const elastic::lanes::Lane<D>& n = surface.n;
  elastic::lanes::Lane<D> turned = {};
  double trace = 0;
  for (int i = 0; i < D; ++i) {
    turned[i] = lanes::dot<D>(n, surface.grad.row[i]);
    trace += surface.grad.row[i][i];
  }
  const double normal = lanes::dot<D>(n, g);
  return surface.area * (lame.mu * (g + normal * n + turned) + (lame.lambda * (normal + trace)) * n);
}

}  // namespace couplet::elastic::least_squares

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
