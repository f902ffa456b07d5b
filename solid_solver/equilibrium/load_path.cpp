// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/equilibrium/load_path.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/elasticity/node_fields.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

// Ratio of a step's length to the last one.
// Largest length of a step over that of the first one.
constexpr double longest = 10;
constexpr double shortest_ratio = 0.5, longest_ratio = 1.5;

}  // namespace

LoadPath::LoadPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const LoadStepping& chosen)
    : mesh_(mesh), geometry_(geometry), chosen_(chosen) {
  double volume = 0;
  for (Index c = 0; c < mesh.cells.n_owned(); ++c) volume += geometry.volume[c];
  volume_ = parallel::sum(mesh.comm, volume);
}

double LoadPath::product(std::span<const double> a, std::span<const double> b) const {
  double sum = 0;
  const std::size_t dim = std::size_t(mesh_.dim);
  for (std::size_t c = 0; c < std::size_t(mesh_.cells.n_owned()); ++c) {
    double here = 0;
    for (std::size_t i = c * dim; i < (c + 1) * dim; ++i) here += a[i] * b[i];
    sum += geometry_.volume[c] * here;
  }
  return parallel::sum(mesh_.comm, sum) / volume_;
}

double LoadPath::predict(std::span<const double> tangent, double dt) {
  const double size = std::sqrt(product(tangent, tangent));
  if (!(size > 0) || !std::isfinite(size))
    throw Error(
        "load-stepping: arc-length: the loads do not move the body, so there is no load path; give loads or prescribed "
        "displacements (those of load factor 1).");
  if (nominal_ == 0) {
    dt_ = dt;
    first_ = nominal_ = chosen_.first_load_factor * size;
  }
  step_ = nominal_ * dt / dt_;
  // Continues in the direction of the path, through limit points of load and displacement.
  const bool is_back = !now_.change.empty() && product(now_.change, tangent) < 0;
  return (is_back ? -1 : 1) * step_ / size;
}

void LoadPath::propose(double factor, std::vector<double> change, int iterations) {
  trial_ = {factor, 1, iterations, std::move(change)};
}

void LoadPath::accept(double time, double stiffness) {
  const double length = std::sqrt(product(trial_.change, trial_.change));
  see_limit(length, time);
  factor_before_ = now_.factor;
  length_before_ = length;
  now_ = trial_;
  now_.stiffness = stiffness;
  travelled_ += length;
  largest_ = std::max(largest_, std::abs(now_.factor));
  const double wanted = std::sqrt(double(chosen_.iterations) / std::max(1, now_.iterations));
  nominal_ = std::min(nominal_ * std::clamp(wanted, shortest_ratio, longest_ratio), longest * first_);
}

/// Locates limit points with the parabola through the last three equilibria.
void LoadPath::see_limit(double length, double time) {
  if (length_before_ == 0 || length == 0) return;
  const double before = (now_.factor - factor_before_) / length_before_,
               after = (trial_.factor - now_.factor) / length;
  if (before * after >= 0) return;
  const double bend = 2 * (after - before) / (length + length_before_),
               slope = before + bend * length_before_ / 2;
  limits_.push_back({now_.factor - slope * slope / (2 * bend), time, before > 0});
}

void LoadPath::visit(io::Archive& archive, const elastic::ElasticOperator& rows) {
  bool has_change = !now_.change.empty();
  archive.common("path", has_change, now_.factor, now_.stiffness, factor_before_, length_before_, dt_, first_,
                 nominal_, travelled_, largest_, limits_);
  now_.change.resize(has_change ? rows.n_unknowns() : 0, 0);
  if (has_change) elastic::visit_unknowns(archive, "path-change", mesh_, rows, now_.change);
}

}  // namespace couplet::solid
