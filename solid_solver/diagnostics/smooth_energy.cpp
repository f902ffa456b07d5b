// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/diagnostics/smooth_energy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"

namespace couplet::solid {
namespace {

constexpr double of_far = 1. / 9;  // weight of a sample at the patch's rim over one in its centre
constexpr GlobalIndex cells_looked_at = 20000;  // of all ranks

}  // namespace

/// Of one cell after the other.
struct SmoothEnergy::Patch {
  mesh::Csr cells_of_point, faces_of_cell;
  std::vector<Index> mark;  // per local cell: for which cell it was last gathered
  std::vector<Index> cells, points;
  std::vector<std::pair<Vec3, Vec3>> mirrors;  // normal and a place of the planes of symmetry
  double reach = 0;
};

SmoothEnergy::SmoothEnergy(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
    : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), counted_(std::size_t(mesh.cells.n_owned()), 0) {}

bool SmoothEnergy::is_of_use(const mesh::Mesh& mesh) {
  const auto is_other = [](mesh::CellType t) { return t != mesh::CellType::triangle; };
  return !parallel::any(mesh.comm, std::ranges::any_of(mesh.cell_type, is_other));
}

void SmoothEnergy::add(Index face, const Tensor3& gradient) {
  const auto [here, there] = elastic::pyramids(mesh_, geometry_, face);
  const auto add_to = [&](Index cell, double volume) {
    if (cell < mesh_.cells.n_owned())
      counted_[std::size_t(cell)] += volume * contraction(rows_.stress(cell, gradient), gradient);
  };
  add_to(mesh_.owner[face], here);
  if (face < mesh_.n_interior) add_to(mesh_.neighbour[face], there);
}

void SmoothEnergy::gather(Index cell, Patch& patch) const {
  const mesh::Geometry& g = geometry_;
  const Vec3 centre = g.cell_centre[cell];
  patch.cells.clear(), patch.points.clear(), patch.mirrors.clear();
  patch.reach = 0;
  gather_cells(mesh_, patch.cells_of_point, cell, patch.mark, patch.cells);
  for (const Index c : patch.cells)
    patch.points.insert(patch.points.end(), mesh_.cell_points[c].begin(), mesh_.cell_points[c].end());
  std::ranges::sort(patch.points);
  patch.points.erase(std::unique(patch.points.begin(), patch.points.end()), patch.points.end());
  for (const Index v : patch.points)
    patch.reach = std::max(patch.reach, (geometry_.points[v] - centre).norm());
  for (const Index c : patch.cells)
    for (const Index f : patch.faces_of_cell[c]) {
      if (!rows_.mirrored(f)) continue;
      const Vec3 normal = g.face_area[f].normalized();
      if (std::ranges::none_of(patch.mirrors, [&](const auto& m) { return m.first.dot(normal) > 0.99; }))
        patch.mirrors.emplace_back(normal, g.face_centre[f]);
    }
}

/// Twice its energy [J]: of a strain that is linear in the cell.
double SmoothEnergy::smooth_energy(Index cell, const Patch& patch, std::span<const double> point_u) const {
  const mesh::Geometry& g = geometry_;
  const int dim = mesh_.dim;
  const Vec3 centre = g.cell_centre[cell];
  QuadraticFit fit;
  fit.start(dim, dim, centre, patch.reach);
  const auto add = [&](const Vec3& place, const Vec3& value) {
    const double far = (place - centre).squaredNorm() / (patch.reach * patch.reach);
    const double weight = 1 / (1 + (1 / of_far - 1) * far);
    fit.add_sample(place, Tensor3::Zero(), {value.data(), 3}, weight);
    for (const auto& [normal, origin] : patch.mirrors) {
      const Vec3 image = value - 2 * normal.dot(value) * normal;
      fit.add_sample(place - 2 * normal.dot(place - origin) * normal, Tensor3::Zero(), {image.data(), 3},
                     weight);
    }
  };
  for (const Index v : patch.points) add(geometry_.points[v], elastic::vector_at(point_u, v, dim));
  fit.solve();
  const auto strain_at = [&](const Vec3& place) {
    Tensor3 gradient = Tensor3::Zero();
    gradient.leftCols(dim) = fit.slopes(place).transpose() * fit.coefficients();
    return Tensor3(0.5 * (gradient + gradient.transpose()));
  };
  const Tensor3 mean = strain_at(centre), moment = cell_moment(mesh_, geometry_, cell);
  double density = contraction(rows_.stress(cell, mean), mean);
  std::array<Tensor3, 3> slope;
  for (int a = 0; a < dim; ++a)
    slope[std::size_t(a)] = (strain_at(centre + patch.reach * Vec3::Unit(a)) - mean) / patch.reach;
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b)
      density += moment(a, b) * contraction(rows_.stress(cell, slope[std::size_t(a)]), slope[std::size_t(b)]);
  return g.volume[cell] * density;
}

double SmoothEnergy::missed(std::span<const double> point_u) const {
  const GlobalIndex stride = 1 + mesh_.cells.n_global() / cells_looked_at;
  Patch patch{.cells_of_point = mesh::transpose(mesh_.cell_points, 0, mesh_.points.n_local()),
              .faces_of_cell = boundary_faces_of_cells(mesh_),
              .mark = std::vector<Index>(std::size_t(mesh_.cells.n_local()), -1),
              .cells = {},
              .points = {},
              .mirrors = {}};
  double smooth = 0, counted = 0;
  for (Index cell = 0; cell < mesh_.cells.n_owned(); ++cell) {
    if (mesh_.cell_id[cell] % stride != 0) continue;  // the same ones on any number of ranks
    gather(cell, patch);
    if (patch.reach == 0) continue;
    smooth += smooth_energy(cell, patch, point_u);
    counted += counted_[std::size_t(cell)];
  }
  smooth = parallel::sum(mesh_.comm, smooth), counted = parallel::sum(mesh_.comm, counted);
  return smooth > 0 ? std::abs(counted / smooth - 1) : 0;
}

}  // namespace couplet::solid
