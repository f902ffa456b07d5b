// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// u = slope^T x: entry (i, j) is d u_j / d x_i.
struct LinearField {
  Tensor3 slope;
  Vec3 at(const Vec3& x) const { return slope.transpose() * x; }
  std::vector<std::string> text(int dim) const {
    std::vector<std::string> result;
    for (int j = 0; j < dim; ++j)
      result.push_back(
          fmt::format("{:.17g}*x + {:.17g}*y + {:.17g}*z", slope(0, j), slope(1, j), slope(2, j)));
    return result;
  }
};

inline LinearField general_field(int dim) {
  LinearField field;
  field.slope << 1.1e-3, -0.4e-3, 0.7e-3, 0.9e-3, 0.6e-3, -0.3e-3, -0.5e-3, 0.8e-3, 1.3e-3;
  if (dim == 2) field.slope.row(2).setZero(), field.slope.col(2).setZero();
  return field;
}

inline std::vector<std::string> traction_text(const SolidParameters& p, const LinearField& field,
                                              const Vec3& n) {
  const elastic::LameConstants lame = lame_constants(p);
  const Tensor3 stress = lame.mu * (field.slope + field.slope.transpose()) +
                         lame.lambda * field.slope.trace() * Tensor3::Identity();
  const Vec3 traction = stress * n;
  std::vector<std::string> result;
  for (int c = 0; c < p.dimension; ++c) result.push_back(fmt::format("{:.17g}", traction[c]));
  return result;
}

/// A mesh and a face gradient; names such as "prisms_symmetric".
using CellsAndGradient = std::tuple<mesh::BoxCells, FaceGradient>;
inline const auto all_cells_and_gradients = ::testing::Combine(
    ::testing::ValuesIn(all_cells), ::testing::Values(FaceGradient::thesis, FaceGradient::symmetric));
inline std::string name_of(const ::testing::TestParamInfo<CellsAndGradient>& info) {
  const auto& [cells, gradient] = info.param;
  return fmt::format("{}_{}", name(cells), gradient == FaceGradient::thesis ? "thesis" : "symmetric");
}

/// With this gradient, solved to round-off.
inline SolidParameters to_round_off(SolidParameters p, FaceGradient gradient) {
  p.method.face_gradient = gradient;
  p.method.relative_tolerance = 1e-13;
  return p;
}

inline mesh::RawMesh distorted_box(mesh::BoxCells cells) {
  mesh::RawMesh raw = mesh::make_box(cells, {5, 4, 3}, Vec3::Zero(), Vec3(1, 0.8, 0.6));
  mesh::perturb_interior(raw, 0.25, 11);
  return raw;
}

/// With the symmetric gradient the scene must be refused, since it cannot have its conditions: true, checked.
inline bool symmetric_refuses(const CellsAndGradient& which, const SolidParameters& p) {
  const auto& [cells, gradient] = which;
  if (gradient != FaceGradient::symmetric) return false;
  EXPECT_THROW(make_solid(distorted_box(cells), to_round_off(p, gradient)), Error);
  return true;
}

/// Largest error of cells, points and traction faces over the largest displacement.
inline double relative_error(const Solid& solid, const LinearField& field) {
  const mesh::Mesh& mesh = solid.body().mesh();
  const mesh::Geometry& geometry = solid.body().geometry();
  const int dim = mesh.dim;
  double error = 0, size = 0;
  const auto compare = [&](std::span<const double> values, Index i, const Vec3& x) {
    for (int a = 0; a < dim; ++a) {
      error = std::max(error, std::abs(values[std::size_t(i) * dim + a] - field.at(x)[a]));
      size = std::max(size, std::abs(field.at(x)[a]));
    }
  };
  for (Index c = 0; c < mesh.cells.n_owned(); ++c)
    compare(solid.stepper().state().cell_u, c, geometry.cell_centre[c]);
  const std::vector<double> points = solid.fields().point_displacement();
  for (Index v = 0; v < mesh.points.n_local(); ++v) compare(points, v, geometry.points[v]);
  for (const Index f : solid.body().elastic().unknown_faces())
    compare(solid.stepper().state().face_u, f - mesh.n_interior, geometry.face_centre[f]);
  return parallel::max(mesh.comm, error) / parallel::max(mesh.comm, size);
}

/// Largest error of the stress over the largest stress.
inline double relative_stress_error(const Solid& solid, const LinearField& field) {
  const Tensor3 exact = solid.body().elastic().stress(0, field.slope);
  double error = 0;
  const int dim = solid.body().mesh().dim;
  for (const Tensor3& s : solid.fields().cell_stress(solid.fields().point_displacement()))
    error = std::max(error, (s - exact).topLeftCorner(dim, dim).norm());
  return parallel::max(solid.body().mesh().comm, error) / exact.norm();
}

inline void expect_exact(const Solid& solid, const LinearField& field) {
  const double error = relative_error(solid, field), stress_error = relative_stress_error(solid, field);
  ::testing::Test::RecordProperty("relative_error", fmt::format("{:.3e}", error));
  ::testing::Test::RecordProperty("relative_stress_error", fmt::format("{:.3e}", stress_error));
  EXPECT_LT(error, 1e-10);
  EXPECT_LT(stress_error, 1e-10);
}

/// Of all cells of all ranks, by cell_id.
inline std::vector<Vec3> displacement_by_cell(const Solid& solid) {
  struct Entry {
    GlobalIndex id;
    double u[3];
  };
  const mesh::Mesh& mesh = solid.body().mesh();
  std::vector<Entry> own;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) {
    own.push_back({mesh.cell_id[c], {0, 0, 0}});
    std::copy_n(&solid.stepper().state().cell_u[std::size_t(c) * mesh.dim], mesh.dim, own.back().u);
  }
  std::vector<Entry> all = parallel::all_gather(mesh.comm, own);
  std::ranges::sort(all, {}, &Entry::id);
  std::vector<Vec3> result;
  for (const Entry& e : all) result.emplace_back(e.u[0], e.u[1], e.u[2]);
  return result;
}

/// Largest difference of the cells' displacements, component by component, over the largest component of `a`.
inline double difference_by_cell(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  double gap = 0, size = 0;
  for (std::size_t c = 0; c < std::min(a.size(), b.size()); ++c) {
    gap = std::max(gap, (a[c] - b[c]).cwiseAbs().maxCoeff());
    size = std::max(size, a[c].cwiseAbs().maxCoeff());
  }
  return gap / size;
}

/// All ranks together find what one rank alone does.
inline void expect_same_on_ranks(const mesh::RawMesh& raw, const SolidParameters& p, double tolerance) {
  EXPECT_LT(difference_by_cell(displacement_by_cell(*stepped(raw, p, MPI_COMM_SELF)),
                               displacement_by_cell(*stepped(raw, p))),
            tolerance);
}

}  // namespace couplet::testing
