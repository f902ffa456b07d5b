// SPDX-License-Identifier: Apache-2.0
#include "mesh_mover/barrier.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "mesh_mover/measures.hpp"

namespace couplet::mesh_mover {
namespace {

/// Simplices of a cell type by corners of the cell.
std::span<const CellCorner> simplices_of(mesh::CellType type) {
  const std::vector<CellCorner>& corners = corners_of(type).corners;
  const bool is_simplex = type == mesh::CellType::triangle || type == mesh::CellType::tetrahedron;
  return {corners.data(), is_simplex ? 1 : corners.size()};
}

template <int D>
void append(const mesh::Mesh& mesh, const mesh::Geometry& geometry, Index cell, double stiffness,
            Simplices& s) {
  using Matrix = Eigen::Matrix<double, D, D>;
  const auto corner = mesh.cell_points[cell];
  const auto all = simplices_of(mesh.cell_type[cell]);
  double sum = 0;
  const std::size_t first = s.weight.size();
  for (const CellCorner& k : all) {
    Matrix edges;
    for (int i = 0; i < D; ++i)
      edges.col(i) = (geometry.points[corner[k[i + 1]]] - geometry.points[corner[k[0]]]).template head<D>();
    const double det = edges.determinant();
    if (!(det > 0)) {
      const Vec3& x = geometry.cell_centre[cell];
      throw SolveFailure(
          "method: barrier requires cells whose corners are all convex; cell {} at ({:.4g}, {:.4g}, {:.4g}) m has a "
          "flat or re-entrant corner.",
          mesh.cell_id[cell], x.x(), x.y(), x.z());
    }
    const Matrix inverse = edges.inverse();
    s.inverse.insert(s.inverse.end(), inverse.data(), inverse.data() + D * D);
    for (int i = 0; i <= D; ++i) s.points.push_back(corner[k[i]]);
    s.cell.push_back(cell);
    s.weight.push_back(det);
    sum += det;
  }
  for (std::size_t i = first; i < s.weight.size(); ++i)
    s.weight[i] *= stiffness * geometry.volume[cell] / sum;
}

// Minimum cosine between normals at a point of one curved surface (26 degrees), and minimum new part of a
// normal relative to held directions (6 degrees).
constexpr double same_surface = 0.9, new_direction = 0.1;

/// Mean normals of the surfaces with the face vectors `areas` around a point.
std::vector<Vec3> surfaces(std::vector<Vec3> areas) {
  std::vector<Vec3> means;
  while (!areas.empty()) {
    const Vec3 first = areas.front().normalized();
    Vec3 mean = Vec3::Zero();
    std::erase_if(areas, [&](const Vec3& a) {
      const bool same = a.normalized().dot(first) > same_surface;
      if (same) mean += a;
      return same;
    });
    means.push_back(mean.normalized());
  }
  return means;
}

/// Projector on the directions held by planes with these face vectors.
Tensor3 held_by(std::vector<Vec3> areas) {
  Tensor3 held = Tensor3::Zero();
  for (const Vec3& n : surfaces(std::move(areas))) {
    const Vec3 across = n - held * n;
    if (across.norm() > new_direction) held += across.normalized() * across.normalized().transpose();
  }
  return held;
}

/// Edges of a simplex: of the reference positions plus a displacement, or of a displacement only.
template <int D>
struct SimplexEdges {
  using Matrix = Eigen::Matrix<double, D, D>;
  const mesh::Mesh& mesh;
  const mesh::Geometry& geometry;
  const Simplices& simplices;

  Matrix placed(Index s, std::span<const double> u) const {
    const Index* p = simplices.points.data() + std::size_t(s) * (D + 1);
    Matrix edges = of(s, u);
    for (int i = 0; i < D; ++i)
      edges.col(i) += (geometry.points[p[i + 1]] - geometry.points[p[0]]).template head<D>();
    return edges;
  }
  Matrix of(Index s, std::span<const double> u) const {
    const Index* p = simplices.points.data() + std::size_t(s) * (D + 1);
    const auto at = [&](Index v) {
      return Eigen::Map<const Eigen::Matrix<double, D, 1>>(u.data() + std::size_t(v) * D);
    };
    Matrix edges;
    for (int i = 0; i < D; ++i) edges.col(i) = at(p[i + 1]) - at(p[0]);
    return edges;
  }
  Eigen::Map<const Matrix> inverse(Index s) const {
    return Eigen::Map<const Matrix>(simplices.inverse.data() + std::size_t(s) * D * D);
  }
};

template <int D>
double energy_here(const SimplexEdges<D>& edges, std::span<const double> u) {
  double sum = 0;
  for (Index s = 0; s < edges.simplices.n_owned; ++s) {
    const Eigen::Matrix<double, D, D> f = edges.placed(s, u) * edges.inverse(s);
    if (!(f.determinant() > 0)) return std::numeric_limits<double>::infinity();
    sum += edges.simplices.weight[s] * Distortion<D>::energy(f);
  }
  return sum;
}

// det(A + a B) as a polynomial of a.
std::array<double, 4> determinant(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
  return {a.determinant(), a(0, 0) * b(1, 1) + b(0, 0) * a(1, 1) - a(0, 1) * b(1, 0) - b(0, 1) * a(1, 0),
          b.determinant(), 0};
}
std::array<double, 4> determinant(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const auto cofactors = [](const Eigen::Matrix3d& m) {
    Eigen::Matrix3d c;
    c.col(0) = m.col(1).cross(m.col(2));
    c.col(1) = m.col(2).cross(m.col(0));
    c.col(2) = m.col(0).cross(m.col(1));
    return c;
  };
  return {a.determinant(), cofactors(a).cwiseProduct(b).sum(), cofactors(b).cwiseProduct(a).sum(),
          b.determinant()};
}

/// Most distorted simplex and its energy per weight; -1 if there is none.
template <int D>
std::pair<Index, double> worst_here(const SimplexEdges<D>& edges, std::span<const double> u) {
  std::pair<Index, double> worst{-1, -1};
  for (Index s = 0; s < edges.simplices.n_owned; ++s) {
    const double energy = Distortion<D>::energy(edges.placed(s, u) * edges.inverse(s));
    if (energy > worst.second) worst = {s, energy};
  }
  return worst;
}

template <int D>
double step_here(const SimplexEdges<D>& edges, std::span<const double> u, std::span<const double> direction,
                 double least) {
  double step = 1;
  for (Index s = 0; s < edges.simplices.n_owned; ++s) {
    std::array<double, 4> c = determinant(edges.placed(s, u), edges.of(s, direction));
    c[0] *= 1 - least;
    step = first_root(c, step);
  }
  return step;
}

}  // namespace

Simplices make_simplices(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double stiffening) {
  Simplices s;
  s.dim = mesh.dim;
  const std::vector<double> stiffness = stiffness_of(mesh, geometry, stiffening);
  for (Index c = 0; c < mesh.cells.n_local(); ++c) {
    mesh.dim == 2 ? append<2>(mesh, geometry, c, stiffness[c], s)
                  : append<3>(mesh, geometry, c, stiffness[c], s);
    if (c + 1 == mesh.cells.n_owned()) s.n_owned = s.size();
  }
  double total = 0;
  for (Index i = 0; i < s.n_owned; ++i) total += s.weight[i];
  s.total = parallel::sum(mesh.comm, total);
  return s;
}

HeldPoints find_held_points(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                            const Parameters& parameters) {
  const Index n = mesh.points.n_local();
  std::vector<char> is_fixed(n, 0), is_moved(n, 0);
  std::vector<std::vector<std::pair<GlobalIndex, Vec3>>> slides(n);
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryMotion motion = parameters.boundaries.at(patch.name).motion;
    if (motion == BoundaryMotion::periodic)
      throw Error(
          "boundaries.{}: method: barrier is not available with periodic patches. Use 'method: pseudo-solid', or "
          "type: slip for both patches.",
          patch.name);
    for_faces(patch, [&](Index f) {
      for (const Index v : mesh.face_points[f]) {
        if (motion == BoundaryMotion::fixed) is_fixed[v] = 1;
        if (is_given(motion)) is_moved[v] = 1;
        if (motion == BoundaryMotion::slip)
          slides[v].emplace_back(mesh.boundary_id[f - mesh.n_interior], geometry.face_area[f]);
      }
    });
  }
  HeldPoints held{std::vector<Tensor3>(n), std::vector<Tensor3>(n)};
  double anything = 0;
  for (Index v = 0; v < n; ++v) {
    // The order is the same on every rank.
    std::ranges::sort(slides[v], {}, &std::pair<GlobalIndex, Vec3>::first);
    std::vector<Vec3> areas;
    for (const auto& [face, area] : slides[v]) areas.push_back(area);
    Tensor3 across = Tensor3::Identity() - held_by(std::move(areas));
    if (mesh.dim == 2) across(2, 2) = 0;
    if (across.norm() < 1e-6) across.setZero();
    held.free[v] = is_fixed[v] || is_moved[v] ? Tensor3(Tensor3::Zero()) : across;
    held.moved[v] = is_moved[v] && !is_fixed[v] ? across : Tensor3(Tensor3::Zero());
    if (is_fixed[v] || is_moved[v]) anything = 1;
  }
  if (parallel::max(mesh.comm, anything) == 0)
    throw Error("No patch constrains the mesh: at least one needs type: fixed, moving or interface.");
  for (std::vector<Tensor3>* tensors : {&held.free, &held.moved})  // a ghost's faces may be on other ranks
    mesh.points.update_ghosts({tensors->data()->data(), tensors->size() * 9}, 9);
  return held;
}

BarrierSystem::BarrierSystem(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                             const Simplices& simplices, const HeldPoints& held)
    : mesh_(mesh), geometry_(geometry), simplices_(simplices), held_(held), dim_(mesh.dim) {
  make_pattern();
}

void BarrierSystem::make_pattern() {
  const Index n = mesh_.points.n_owned();
  const int corners = dim_ + 1;
  std::vector<std::vector<Index>> around(n);
  for (Index s = 0; s < simplices_.size(); ++s) {
    const Index* p = simplices_.points.data() + std::size_t(s) * corners;
    for (int k = 0; k < corners; ++k)
      if (p[k] < n) around[p[k]].insert(around[p[k]].end(), p, p + corners);
  }
  for (Index v = 0; v < n; ++v) {
    around[v].push_back(v);  // a point without simplices, such as the apex of a single pyramid on its rank
    std::ranges::sort(around[v]);
    around[v].erase(std::unique(around[v].begin(), around[v].end()), around[v].end());
    diagonal_.push_back(graph_.offset[v] +
                        static_cast<Index>(std::ranges::lower_bound(around[v], v) - around[v].begin()));
    graph_.push_row(around[v]);
  }
  for (Index s = 0; s < simplices_.size(); ++s) {
    const Index* p = simplices_.points.data() + std::size_t(s) * corners;
    for (int k = 0; k < corners; ++k)
      for (int l = 0; l < corners; ++l) {
        const auto row = p[k] < n ? graph_[p[k]] : std::span<const Index>{};
        entry_.push_back(p[k] < n ? graph_.offset[p[k]] +
                                        static_cast<Index>(std::ranges::lower_bound(row, p[l]) - row.begin())
                                  : -1);
      }
  }
  blocks_.assign(graph_.index.size() * dim_ * dim_, 0.0);
  std::vector<GlobalIndex> row, column;
  for (Index v = 0; v < n; ++v)
    for (const Index w : graph_[v])
      for (int i = 0; i < dim_; ++i)
        for (int j = 0; j < dim_; ++j) {
          row.push_back(mesh_.points.global(v) * dim_ + i);
          column.push_back(mesh_.points.global(w) * dim_ + j);
        }
  matrix_ = std::make_unique<linalg::SparseMatrix>(mesh_.comm, GlobalIndex(n) * dim_, std::move(row),
                                                   std::move(column), dim_);
}

double BarrierSystem::energy(std::span<const double> u) const {
  return parallel::sum(mesh_.comm, dim_ == 2 ? energy_here(SimplexEdges<2>{mesh_, geometry_, simplices_}, u)
                                             : energy_here(SimplexEdges<3>{mesh_, geometry_, simplices_}, u));
}

double BarrierSystem::largest_step(std::span<const double> u, std::span<const double> direction,
                                   double least) const {
  return parallel::min(
      mesh_.comm, dim_ == 2 ? step_here(SimplexEdges<2>{mesh_, geometry_, simplices_}, u, direction, least)
                            : step_here(SimplexEdges<3>{mesh_, geometry_, simplices_}, u, direction, least));
}

// Per simplex with the gradients b_k of its corner functions: g_k = w P b_k and H_kl = w b_k . d2W/dF2 . b_l,
// in the frame of its stretches.
template <int D>
void BarrierSystem::add_simplices(std::span<const double> u, std::span<const double> known,
                                  std::vector<double>& residual, Hessian hessian) {
  using Matrix = Eigen::Matrix<double, D, D>;
  using Vector = Eigen::Matrix<double, D, 1>;
  const SimplexEdges<D> edges{mesh_, geometry_, simplices_};
  const Index n = mesh_.points.n_owned();
  Matrix h[D + 1][D + 1];
  for (Index s = 0; s < simplices_.size(); ++s) {
    const Index* p = simplices_.points.data() + std::size_t(s) * (D + 1);
    const Index* entry = entry_.data() + std::size_t(s) * (D + 1) * (D + 1);
    const double w = simplices_.weight[s];
    const Matrix inverse = edges.inverse(s), f = edges.placed(s, u) * inverse;
    const Matrix stress = w * Distortion<D>::stress(f);
    for (int k = 0; k <= D; ++k) h[k][0].setZero(), h[0][k].setZero();
    const auto set = [&](const auto& block) {
      for (int k = 0; k < D; ++k)
        for (int l = 0; l <= k; ++l) {
          h[k + 1][l + 1] = w * block(k, l);
          if (k != l) h[l + 1][k + 1] = h[k + 1][l + 1].transpose();
        }
    };
    if (hessian == Hessian::exact) {
      set(typename Distortion<D>::SecondDerivative(f, inverse.transpose()));
    } else {
      const auto t = Distortion<D>::tangent(f);
      const Matrix gradients = t.v.transpose() * inverse.transpose();  // of corners 1 .. D, turned
      set([&](int k, int l) -> Matrix {
        Matrix turned = Matrix::Zero();
        for (int i = 0; i < D; ++i)
          for (int j = 0; j < D; ++j) {
            if (i != j) turned(i, j) = t.across(i, j) * gradients(j, k) * gradients(i, l);
            turned(i, i) += t.own(i, j) * gradients(j, k) * gradients(j, l);
          }
        return t.u * turned * t.u.transpose();
      });
    }
    for (int k = 1; k <= D; ++k) {
      for (int l = 1; l <= D; ++l) h[k][0] -= h[k][l];
      h[0][k] = h[k][0].transpose();
      h[0][0] -= h[0][k];
    }
    Vector force[D + 1];
    force[0].setZero();
    for (int k = 1; k <= D; ++k) {
      force[k] = stress * inverse.row(k - 1).transpose();
      force[0] -= force[k];
    }
    for (int k = 0; k <= D; ++k) {
      if (p[k] >= n) continue;
      for (int l = 0; l <= D; ++l) {
        force[k] += h[k][l] * Eigen::Map<const Vector>(known.data() + std::size_t(p[l]) * D);
        Eigen::Map<Eigen::Matrix<double, D, D, Eigen::RowMajor>>(
            blocks_.data() + std::size_t(entry[k * (D + 1) + l]) * D * D) += h[k][l];
      }
      Eigen::Map<Vector>(residual.data() + std::size_t(p[k]) * D) -= force[k];
    }
  }
}

/// P H P + (I - P) in the owned rows, with unit entries scaled to the size of the others.
template <int D>
void BarrierSystem::finish_rows(std::vector<double>& residual) {
  using Block = Eigen::Matrix<double, D, D, Eigen::RowMajor>;
  const Block identity = Block::Identity();
  for (Index v = 0; v < mesh_.points.n_owned(); ++v) {
    const Block mine = held_.free[v].template topLeftCorner<D, D>();
    const bool is_free = mine == identity;
    Eigen::Map<Block> own(blocks_.data() + std::size_t(diagonal_[v]) * D * D);
    const double size = own.trace() > 0 ? own.trace() / D : 1;
    for (Index e = graph_.offset[v]; e < graph_.offset[v + 1]; ++e) {
      const Block other = held_.free[graph_.index[e]].template topLeftCorner<D, D>();
      if (is_free && other == identity) continue;
      Eigen::Map<Block> block(blocks_.data() + std::size_t(e) * D * D);
      block = (mine * block * other).eval();
    }
    if (is_free) continue;
    own += size * (identity - mine);
    Eigen::Map<Eigen::Matrix<double, D, 1>> r(residual.data() + std::size_t(v) * D);
    r = (mine * r).eval();
  }
}

Vec3 BarrierSystem::worst_place(std::span<const double> u) const {
  const auto [simplex, energy] = dim_ == 2 ? worst_here(SimplexEdges<2>{mesh_, geometry_, simplices_}, u)
                                           : worst_here(SimplexEdges<3>{mesh_, geometry_, simplices_}, u);
  struct EnergyPoint {
    double energy;
    std::array<double, 3> place{};
  } here{energy};
  for (int i = 0; simplex >= 0 && i <= dim_; ++i) {
    const Index v = simplices_.points[std::size_t(simplex) * (dim_ + 1) + i];
    for (int c = 0; c < dim_; ++c)
      here.place[c] += (geometry_.points[v][c] + u[std::size_t(v) * dim_ + c]) / (dim_ + 1);
  }
  const std::vector<EnergyPoint> all = parallel::all_gather(mesh_.comm, std::vector<EnergyPoint>{here});
  const EnergyPoint& worst = *std::ranges::max_element(all, {}, &EnergyPoint::energy);
  return {worst.place[0], worst.place[1], worst.place[2]};
}

void BarrierSystem::assemble(std::span<const double> u, std::span<const double> known,
                             std::vector<double>& residual, Hessian hessian) {
  std::ranges::fill(blocks_, 0.0);
  residual.assign(std::size_t(mesh_.points.n_owned()) * dim_, 0.0);
  if (dim_ == 2) {
    add_simplices<2>(u, known, residual, hessian);
    finish_rows<2>(residual);
  } else {
    add_simplices<3>(u, known, residual, hessian);
    finish_rows<3>(residual);
  }
  matrix_->fill(blocks_);
}

}  // namespace couplet::mesh_mover
