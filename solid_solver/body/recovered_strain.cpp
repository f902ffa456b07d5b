// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/body/recovered_strain.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/quadratic_fit.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {

namespace {

constexpr GlobalIndex patches_looked_at = 100000;  // of all ranks
constexpr double no_slope = 1e-9;                  // of a slope that no neighbor determines

}  // namespace

RecoveredStrain::RecoveredStrain(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
    : mesh_(mesh),
      geometry_(rows.geometry()),
      rows_(rows),
      mean_(std::size_t(mesh.cells.n_local()) * tensor_size, 0.0),
      volume_(std::size_t(mesh.cells.n_local()), 0.0) {}

template <class Visit>
void RecoveredStrain::visit_pyramids(Index face, const Visit& visit) const {
  const auto [here, there] = elastic::pyramids(mesh_, geometry_, face);
  if (mesh_.owner[face] < mesh_.cells.n_owned())
    visit(mesh_.owner[face], Vec3(geometry_.face_centre[face]), here);
  if (face < mesh_.n_interior && mesh_.neighbour[face] < mesh_.cells.n_owned())
    visit(mesh_.neighbour[face], Vec3(geometry_.face_centre[face] - mesh_.shift(face)), there);
}

void RecoveredStrain::add(Index face, const Tensor3& strain) {
  const PackedTensor packed = pack(strain);
  visit_pyramids(face, [&](Index cell, const Vec3&, double volume) {
    volume_[std::size_t(cell)] += volume;
    for (std::size_t i = 0; i < packed.size(); ++i)
      mean_[std::size_t(cell) * tensor_size + i] += volume * packed[i];
  });
}

void RecoveredStrain::recover() {
  const GlobalIndex stride = 1 + mesh_.cells.n_global() / patches_looked_at;
  for (std::size_t c = 0; c < std::size_t(mesh_.cells.n_owned()); ++c)
    for (std::size_t i = 0; i < std::size_t(tensor_size); ++i)
      if (volume_[c] > 0) mean_[c * tensor_size + i] /= volume_[c];
  mesh_.cells.update_ghosts(mean_, tensor_size);
  const mesh::Csr cells_of_point = mesh::transpose(mesh_.cell_points, 0, mesh_.points.n_local());
  std::vector<Index> mark(std::size_t(mesh_.cells.n_local()), -1), patch;
  slot_.assign(std::size_t(mesh_.cells.n_owned()), -1);
  for (Index cell = 0; cell < mesh_.cells.n_owned(); ++cell) {
    if (mesh_.cell_id[cell] % stride != 0) continue;  // the same ones on any number of ranks
    patch.clear();
    gather_cells(mesh_, cells_of_point, cell, mark, patch);
    slot_[std::size_t(cell)] = Index(linear_.size());
    linear_.push_back(fit(cell, patch));
  }
  // Frees memory at its peak.
  std::vector<double>().swap(mean_), std::vector<double>().swap(volume_);
}

RecoveredStrain::Linear RecoveredStrain::fit(Index cell, const std::vector<Index>& patch) const {
  using Terms = Eigen::Vector4d;
  const Vec3 centre = geometry_.cell_centre[cell];
  Vec3 reach = Vec3::Zero();  // along each axis: thin cells have slopes, too
  for (const Index c : patch) reach = reach.cwiseMax((geometry_.cell_centre[c] - centre).cwiseAbs());
  const double longest = reach.maxCoeff();
  for (int a = 0; a < 3; ++a) reach[a] = reach[a] > no_slope * longest ? 1 / reach[a] : 0;
  Eigen::Matrix4d of = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, tensor_size> right = Eigen::Matrix<double, 4, tensor_size>::Zero();
  for (const Index c : patch) {
    Terms phi;
    phi << 1, reach.cwiseProduct(geometry_.cell_centre[c] - centre);
    of += phi * phi.transpose();
    right +=
        phi * Eigen::Map<const Eigen::Matrix<double, 1, tensor_size>>(&mean_[std::size_t(c) * tensor_size]);
  }
  of.diagonal().array() += no_slope;
  const Eigen::Matrix<double, 4, tensor_size> coefficients = of.llt().solve(right);
  Linear linear{};
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < tensor_size; ++k)
      linear[std::size_t(i)][std::size_t(k)] = float(coefficients(i, k) * (i == 0 ? 1 : reach[i - 1]));
  return linear;
}

void RecoveredStrain::compare(Index face, const Tensor3& strain) {
  const PackedTensor packed = pack(strain);
  visit_pyramids(face, [&](Index cell, const Vec3& place, double volume) {
    const Index slot = slot_[std::size_t(cell)];
    if (slot < 0) return;
    const Linear& linear = linear_[std::size_t(slot)];
    const Vec3 x = place - geometry_.cell_centre[cell];
    PackedTensor gap = packed;
    for (std::size_t k = 0; k < gap.size(); ++k)
      gap[k] -= double(linear[0][k]) + linear[1][k] * x[0] + linear[2][k] * x[1] + linear[3][k] * x[2];
    const Tensor3 missed = unpack(gap);
    difference_ += volume * contraction(rows_.stress(cell, missed), missed);
    whole_ += volume * contraction(rows_.stress(cell, strain), strain);
  });
}

double RecoveredStrain::missed() const {
  const double difference = parallel::sum(mesh_.comm, difference_), whole = parallel::sum(mesh_.comm, whole_);
  return whole > 0 ? difference / whole : 0;
}

namespace {

constexpr double of_rim = 1. / 9;  // weight of a sample at the patch's rim over one in its centre
constexpr GlobalIndex cells_looked_at = 20000;  // of all ranks

}  // namespace

/// Data of the current cell.
struct SmoothEnergy::Patch {
  mesh::Csr cells_of_point, faces_of_cell;
  std::vector<Index> mark;  // per local cell: for which cell it was last gathered
  std::vector<Index> cells, points;
  std::vector<MirrorPlane> mirrors;
  double reach = 0;
};

SmoothEnergy::SmoothEnergy(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows)
    : mesh_(mesh), geometry_(rows.geometry()), rows_(rows), counted_(std::size_t(mesh.cells.n_owned()), 0) {}

bool SmoothEnergy::is_of_use(const mesh::Mesh& mesh) {
  const auto is_other = [](mesh::CellType t) { return t != mesh::CellType::triangle; };
  return !parallel::any(mesh.comm, std::ranges::any_of(mesh.cell_type, is_other));
}

void SmoothEnergy::add(Index face, const Tensor3& gradient) {
  elastic::visit_sides(mesh_, geometry_, face, [&](Index cell, double volume) {
    counted_[std::size_t(cell)] += volume * contraction(rows_.stress(cell, gradient), gradient);
  });
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
    for (const Index f : patch.faces_of_cell[c])
      if (rows_.mirrored(f)) add_mirror(g, f, patch.mirrors);
}

/// Twice its energy [J], for a strain that is linear in the cell.
double SmoothEnergy::smooth_energy(Index cell, const Patch& patch, std::span<const double> point_u) const {
  const mesh::Geometry& g = geometry_;
  const int dim = mesh_.dim;
  const Vec3 centre = g.cell_centre[cell];
  QuadraticFit fit;
  fit.start(dim, dim, centre, patch.reach);
  const auto add = [&](const Vec3& place, const Vec3& value) {
    const double far = (place - centre).squaredNorm() / (patch.reach * patch.reach);
    const double weight = 1 / (1 + (1 / of_rim - 1) * far);
    fit.add_sample(place, Tensor3::Zero(), {value.data(), 3}, weight);
    for (const MirrorPlane& m : patch.mirrors) {
      const Vec3 image = m.reflect(value);
      fit.add_sample(m.image(place), Tensor3::Zero(), {image.data(), 3}, weight);
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
