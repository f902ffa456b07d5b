// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/equilibrium/large_strain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "common/base/error.hpp"
#include "common/elasticity/symmetric/symmetric_faces.hpp"
#include "common/fv/gradients.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

// Round-off of a residual relative to the stiffness.
constexpr double last_digits = 2e-15;

}  // namespace

double rounding_of_forces(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const double force = (2 * lame.mu + lame.lambda) * geometry.face_area[f].norm();
    square += 2 * force * force;
  }
  return last_digits * std::sqrt(parallel::sum(mesh.comm, square));
}

double rounding_of_motion(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  const mesh::Geometry& geometry = rows.geometry();
  double square = 0;
  for (Index f = 0; f < mesh.n_flux_faces(); ++f) {
    if (mesh.owner[f] >= mesh.cells.n_owned()) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const fv::FaceLine line = fv::face_line(mesh, geometry, f);
    const double stiffness = (2 * lame.mu + lame.lambda) * line.area * line.inverse_dn;
    square += 2 * stiffness * stiffness;
  }
  return std::numeric_limits<double>::epsilon() * std::sqrt(parallel::sum(mesh.comm, square));
}

std::string worst_cell(const mesh::Mesh& mesh, const mesh::Geometry& geometry, double ratio, Index face) {
  struct Place {
    double ratio, x[3];
  };
  Place here{ratio, {0, 0, 0}};
  if (face >= 0)
    for (int a = 0; a < 3; ++a) here.x[a] = geometry.cell_centre[mesh.owner[face]][a];
  const std::vector<Place> all = parallel::all_gather(mesh.comm, std::vector<Place>{here});
  const Place& w = *std::ranges::min_element(all, {}, &Place::ratio);
  if (!(w.ratio < 1)) return "No cell is compressed.";
  return fmt::format("The worst cell is at ({:.4g}, {:.4g}, {:.4g}) m (undeformed), where det F = {:.3g}.",
                     w.x[0], w.x[1], w.x[2], w.ratio);
}

/// sigma = P F^T / J.
std::vector<Tensor3> LargeStrain::face_stress(const Displaced& state, Index first, Index count) {
  std::vector<Tensor3> stress(count, Tensor3::Zero());
  visit(state.unknowns(), state.known, [&](Index f, const Tensor3& deformation, const Tensor3& p) {
    if (f < first || f >= first + count) return;
    stress[f - first] = p * deformation.transpose() / deformation.determinant();
  });
  return stress;
}

/// Cell stress weighted by the pyramids over the faces: sum V_fP P F^T / sum V_fP J, the mean over the
/// deformed cell. Other ranks own the faces of ghosts.
std::vector<Tensor3> LargeStrain::cell_stress(const Displaced& state) {
  constexpr int size = 10;
  std::vector<double> sums(std::size_t(mesh_.cells.n_local()) * size, 0);
  visit(state.unknowns(), state.known, [&](Index f, const Tensor3& deformation, const Tensor3& p) {
    const auto [here, there] = elastic::pyramids(mesh_, geometry_, f);
    const Tensor3 tau = p * deformation.transpose();
    const double j = deformation.determinant();
    const auto add = [&](Index c, double volume) {
      double* at = sums.data() + std::size_t(c) * size;
      for (int i = 0; i < 9; ++i) at[i] += volume * tau(i / 3, i % 3);
      at[9] += volume * j;
    };
    add(mesh_.owner[f], here);
    if (f < mesh_.n_interior) add(mesh_.neighbour[f], there);
  });
  mesh_.cells.add_to_owners(sums, size);
  std::vector<Tensor3> stress(mesh_.cells.n_owned());
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
    for (int i = 0; i < 9; ++i)
      stress[c](i / 3, i % 3) =
          sums[std::size_t(c) * size + std::size_t(i)] / sums[std::size_t(c) * size + 9];
  return stress;
}

namespace {

struct Fold {
  double height = 0;  // beyond the plane of the support [m]
  Index support = -1;
};

// Rings of free faces from the rim of the support: the first may be flattened while the next folds over it.
constexpr int rings = 3;

using FacesOfPoints = std::vector<std::vector<Index>>;

FacesOfPoints supports_of_points(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows) {
  FacesOfPoints supports(std::size_t(mesh.points.n_local()));
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (rows.at(f).fixed)
      for (const Index v : mesh.face_points[f]) supports[std::size_t(v)].push_back(f);
  return supports;
}

Fold largest_fold(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                  const std::function<Vec3(Index)>& displacement) {
  const mesh::Geometry& g = rows.geometry();
  const auto place = [&](Index f) {
    return Vec3(g.face_centre[f] + displacement(mesh.cells.n_local() + f - mesh.n_interior));
  };
  Fold most;
  FacesOfPoints supports = supports_of_points(mesh, rows);
  for (int ring = 0; ring < rings; ++ring) {
    FacesOfPoints next = supports;
    for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
      if (!rows.at(f).is_free()) continue;
      for (const Index v : mesh.face_points[f])
        for (const Index support : supports[std::size_t(v)]) {
          const Vec3 normal = g.face_area[support].normalized();
          if (normal.dot(g.face_centre[f] - g.face_centre[support]) > 0) continue;  // a step from the start
          const double height = normal.dot(place(f) - place(support));
          if (height > most.height) most = {height, support};
          for (const Index w : mesh.face_points[f])
            if (auto& known = next[std::size_t(w)]; std::ranges::find(known, support) == known.end())
              known.push_back(support);
        }
    }
    supports = std::move(next);
  }
  return most;
}

}  // namespace

std::string folded_support(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows,
                           const std::function<Vec3(Index)>& displacement) {
  const Fold here = largest_fold(mesh, rows, displacement);
  struct Told {
    double height;
    int patch;
  };
  Told told{here.height, -1};
  for (std::size_t p = 0; p < mesh.patches.size(); ++p)
    if (here.support >= mesh.patches[p].first && here.support < mesh.patches[p].first + mesh.patches[p].count)
      told.patch = int(p);
  const std::vector<Told> all = parallel::all_gather(mesh.comm, std::vector<Told>{told});
  const Told& most = *std::ranges::max_element(all, {}, &Told::height);
  if (!(most.height > 0) || most.patch < 0) return "";
  return fmt::format(
      "Next to '{}' the free surface has folded past the plane of the support by {:.2g} m. It would touch a wider support "
      "there, which is not modeled. Beyond this load, equilibrium is lost cell by cell, and earlier on finer meshes. End the "
      "load here, or let the sides widen toward the support.",
      mesh.patches[std::size_t(most.patch)].name, most.height);
}

namespace {

// Motion beyond both tangents relative to the largest motion. A bonded rubber block of 16 x 16 cells had at
// most 0.08 at a limit point of rim cells, 0.13-0.95 past it; an arch at 1.05 and 8 limit loads 0.88, 0.34.
constexpr double limit = 0.15;

}  // namespace

void StepJump::start(std::span<const double> u, int dim) {
  before_.assign(u.begin(), u.end());
  predicted_.assign(u.size(), 0);
  dim_ = std::size_t(dim);
}

void StepJump::predict(std::span<const double> u, std::span<const double> correction) {
  for (std::size_t i = 0; i < u.size(); ++i) predicted_[i] = u[i] - before_[i] + correction[i];
}

/// This rank's.
double StepJump::largest_growth(double length) const {
  double largest = 0;
  for (std::size_t i = 0; i < stretch_.size(); ++i)
    largest = std::max(largest, std::abs(stretch_[i] - (settled_.empty() ? 1 : settled_[i])));
  return largest * length;
}

/// Largest relative excess of a node's motion over both predictions and growth. `later` may be empty.
double StepJump::beyond(MPI_Comm comm, std::span<const double> u, std::span<const double> later,
                        double growth) const {
  std::array<double, 3> found{0, 0, growth};
  for (std::size_t i = 0; i + dim_ <= u.size(); i += dim_) {
    double motion = 0, first = 0, last = 0;
    for (std::size_t k = i; k < i + dim_; ++k) {
      motion += (u[k] - before_[k]) * (u[k] - before_[k]);
      first += predicted_[k] * predicted_[k];
      if (!later.empty()) last += later[k] * later[k];
    }
    found[0] = std::max(found[0], std::sqrt(motion) - std::sqrt(std::max(first, last)));
    found[1] = std::max(found[1], std::sqrt(motion));
  }
  MPI_Allreduce(MPI_IN_PLACE, found.data(), 3, MPI_DOUBLE, MPI_MAX, comm);
  return found[1] > 0 ? (found[0] - found[2]) / found[1] : 0;
}

void StepJump::end(MPI_Comm comm, std::span<const double> u, double length, const Backward& backward) {
  const double growth = largest_growth(length);
  if (beyond(comm, u, {}, growth) <= limit) return;
  std::vector<double> later;
  try {
    later = backward(before_);
  } catch (const SolveFailure&) {
    return;  // an indefinite tangent: the least stiffness shows it
  }
  if (const double found = beyond(comm, u, later, growth); found > limit)
    throw SolveFailure(
        "The load step moved part of the body farther than the stiffness before and after the step implies, by {:.2g} of the "
        "largest motion (limit {:g}): it jumped past a limit point of the load, or past soft states that a shorter step would "
        "find; 'load-stepping: {{type: arc-length}}' follows a path through limit points.",
        found, limit);
}

}  // namespace couplet::solid
