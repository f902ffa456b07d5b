// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "common/linalg/matrix.hpp"
#include "common/mesh/mesh.hpp"
#include "mesh_mover/methods.hpp"
#include "mesh_mover/parameters.hpp"

namespace couplet::mesh_mover {

/// Simplices that the barrier keeps from inverting: triangles and tetrahedra themselves, in other cells one
/// at each corner, spanned by its edges. Flat arrays over the local cells, owned cells first.
struct Simplices {
  int dim = 0;
  Index n_owned = 0;            ///< of owned cells; every simplex of the mesh counts on one rank
  std::vector<Index> points;    ///< dim + 1 local points each
  std::vector<double> inverse;  ///< inverse of the reference edges, dim x dim by columns each [1/m]
  std::vector<double> weight;   ///< share of its cell's reference volume times (V / mean V)^-chi [m^dim]
  std::vector<Index> cell;      ///< local cell each
  double total = 0;             ///< sum of the weights over all ranks
  Index size() const { return static_cast<Index>(weight.size()); }
};

/// Throws SolveFailure for a flat or inverted reference simplex. Collective.
Simplices make_simplices(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening);

/// Symmetric Dirichlet energy [smith2015] of a simplex with the deformation gradient F and stretches s_i,
///   W = |F|^2 + |F^-1|^2 - 2 D = sum_i (s_i^2 + s_i^-2 - 2).
/// It is zero only for rigid motions and infinite as det F -> 0. Compression to a ratio s costs as much as
/// stretching by 1/s.
template <int D>
struct Distortion {
  using Matrix = Eigen::Matrix<double, D, D>;

  static double energy(const Matrix& f) { return f.squaredNorm() + f.inverse().squaredNorm() - 2 * D; }

  /// dW/dF = 2 F - 2 F^-T F^-1 F^-T.
  static Matrix stress(const Matrix& f) {
    const Matrix inverse = f.inverse();
    return 2 * f - 2 * (inverse * inverse.transpose() * inverse).transpose();
  }

  /// b_k . d2W/dF2 . b_l for the columns of `b`; it may be negative.
  struct SecondDerivative {
    Matrix b, a, c, ac;
    SecondDerivative(const Matrix& f, const Matrix& columns)
        : b(columns), a(f.inverse().transpose() * f.inverse()), c(f.inverse().transpose() * b), ac(a * c) {}
    Matrix operator()(int k, int l) const {
      return 2 * (b.col(k).dot(b.col(l)) * Matrix::Identity() + c.col(k).dot(c.col(l)) * a +
                  ac.col(l) * c.col(k).transpose() + c.col(l) * ac.col(k).transpose());
    }
  };

  /// Its positive part in the frame of the stretches, F = U diag(s) V^T [smith2019]: coupling of the entry (ij)
  /// with itself (`own`) and with (ji) (`across`). W''(s_i) = 2 + 6 s_i^-4; each pair has a symmetric mode (W'_i -
  /// W'_j)/(s_i - s_j) and an antisymmetric one (W'_i + W'_j)/(s_i + s_j), which alone may be negative.
  struct Tangent {
    Matrix u, v;
    Matrix own, across;
  };
  static Tangent tangent(const Matrix& f) {
    Eigen::SelfAdjointEigenSolver<Matrix> eigen;
    eigen.computeDirect(f.transpose() * f);
    Tangent t;
    t.v = eigen.eigenvectors();
    t.u = f * t.v;
    std::array<double, D> s;
    for (int i = 0; i < D; ++i) {
      s[i] = t.u.col(i).norm();
      t.u.col(i) /= s[i];
      t.own(i, i) = 2 + 6 / (s[i] * s[i] * s[i] * s[i]);
      t.across(i, i) = 0;
    }
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < i; ++j) {
        const double product = s[i] * s[j], cube = product * product * product;
        const double squares = s[i] * s[i] + s[j] * s[j];
        const double even = 2 + 2 * (squares + product) / cube;
        const double odd = std::max(2 - 2 * (squares - product) / cube, 0.0);
        t.own(i, j) = t.own(j, i) = (even + odd) / 2;
        t.across(i, j) = t.across(j, i) = (even - odd) / 2;
      }
    return t;
  }
};

/// Directions in which patches hold or move a point. If a point is on several patches, `fixed` overrides
/// motion, and the plane of a sliding patch overrides both, so that corners stay closed. Where such planes
/// meet at an edge the point slides along it; where they meet at a corner it is fixed.
struct HeldPoints {
  /// Per local point: projectors on its free directions (I inside the mesh, 0 if all are given) and on those
  /// with a prescribed motion.
  std::vector<Tensor3> free, moved;
};

/// Throws Error if no patch holds or moves the mesh, or if one is periodic. Collective.
HeldPoints find_held_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                            const Parameters& parameters);

/// First zero in (0, limit] of c0 + c1 a + c2 a^2 + c3 a^3, from below, with a relative error of 1e-3; limit
/// if there is none. c0 > 0.
inline double first_root(const std::array<double, 4>& c, double limit) {
  const auto at = [&](double a) { return c[0] + a * (c[1] + a * (c[2] + a * c[3])); };
  const auto below = [](double x) { return x < 0 ? x : 0; };
  if (c[0] + limit * (below(c[1]) + limit * (below(c[2]) + limit * below(c[3]))) > 0) return limit;
  // The function is monotone between its extrema.
  std::array<double, 3> ends{limit, limit, limit};
  int n = 0;
  const double a = 3 * c[3], b = c[2], root = b * b - a * c[1];
  if (root >= 0) {
    const double q = -(b + (b > 0 ? std::sqrt(root) : -std::sqrt(root)));
    const double first = a != 0 ? q / a : -1, second = q != 0 ? c[1] / q : -1;
    for (const double x : {std::fmin(first, second), std::fmax(first, second)})
      if (x > 0 && x < limit) ends[n++] = x;
  }
  ends[n++] = limit;
  double low = 0;
  for (int i = 0; i < n; ++i) {
    if (at(ends[i]) > 0) {
      low = ends[i];
      continue;
    }
    double high = ends[i];
    while (high - low > 1e-3 * high) {
      const double middle = (low + high) / 2;
      (at(middle) > 0 ? low : high) = middle;
      if (high < 1e-12 * limit) break;
    }
    return low;
  }
  return limit;
}

/// Distortion energy of the simplices of a mesh, its gradient and projected Hessian over the owned points.
/// Positions and directions have dim values per local point, ghosts current.
class BarrierSystem {
 public:
  enum class Hessian { exact, projected };
  /// Keeps references. Collective.
  BarrierSystem(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Simplices& simplices,
                const HeldPoints& held);

  /// Sum of weight x W; infinite if a simplex is flat or inverted. Collective.
  double energy(std::span<const double> displacement) const;
  /// Assembles the matrix P H P + (I - P), where `hessian` may remove the negative parts of H. Returns in
  /// `residual` the right-hand side -P (g + H `known`) of the step that moves the prescribed directions by
  /// `known`. Collective.
  void assemble(std::span<const double> displacement, std::span<const double> known,
                std::vector<double>& residual, Hessian hessian);
  /// Largest share of `direction`, at most 1, such that each simplex keeps `least` of its volume. Collective.
  double largest_step(std::span<const double> displacement, std::span<const double> direction,
                      double least) const;
  /// Moved position [m] of the cell with the largest energy per weight. Collective.
  Vec3 worst_place(std::span<const double> displacement) const;
  const linalg::SparseMatrix& matrix() const { return *matrix_; }

 private:
  template <int D>
  void add_simplices(std::span<const double> displacement, std::span<const double> known,
                     std::vector<double>& residual, Hessian hessian);
  template <int D>
  void finish_rows(std::vector<double>& residual);
  void make_pattern();

  const mesh::Mesh& mesh_;
  const mesh::Geometry& geometry_;
  const Simplices& simplices_;
  const HeldPoints& held_;
  int dim_;
  mesh::Csr graph_;              // per owned point: local points of adjacent simplices
  std::vector<Index> diagonal_;  // per owned point: its own entry of the graph
  std::vector<Index> entry_;     // per simplex and pair of points: entry of the graph; -1 if not an owned row
  std::vector<double> blocks_;   // per entry of the graph: dim x dim by rows
  std::unique_ptr<linalg::SparseMatrix> matrix_;
};

}  // namespace couplet::mesh_mover
