// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/truncation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"

namespace couplet::plate {
namespace {

double square_of_omega(double frequency) { return std::pow(2 * std::numbers::pi * frequency, 2); }

/// The square of the first frequency above 0 [1/s^2].
double first_elastic(const modes::ModalModel& model) {
  for (const double f : model.frequency)
    if (f > 0) return square_of_omega(f);
  return 1;
}

/// Sixteen points of equal weight: middles of the pieces of two halvings.
std::vector<Vec3> points_within(const modes::ModalModel& model, std::span<const Index> face) {
  std::vector<Vec3> points;
  const auto at = [&](std::size_t i) -> const Vec3& { return model.vertices[face[i]]; };
  if (face.size() == 4) {
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const double x = (i + 0.5) / 4, y = (j + 0.5) / 4;
        points.push_back((1 - x) * (1 - y) * at(0) + x * (1 - y) * at(1) + x * y * at(2) +
                         (1 - x) * y * at(3));
      }
    return points;
  }
  // Rows of a triangle cut into quarters of its edges: pieces that stand and pieces that hang.
  const auto add = [&](double x, double y) {
    points.push_back(at(0) + x * (at(1) - at(0)) + y * (at(2) - at(0)));
  };
  for (int i = 0; i < 4; ++i)
    for (int j = 0; i + j < 4; ++j) {
      add((i + 1. / 3) / 4, (j + 1. / 3) / 4);
      if (i + j < 3) add((i + 2. / 3) / 4, (j + 2. / 3) / 4);
    }
  return points;
}

/// Component of a shape along a direction at entry i, mode m.
double along(const modes::ModalModel& model, const std::vector<double>& shape, std::size_t i, std::size_t m,
             const Vec3& direction) {
  const std::size_t n = model.n_modes();
  const double* u = shape.data() + 3 * i * n + m;
  return Vec3(u[0], u[n], u[2 * n]).dot(direction);
}

}  // namespace

Truncation::Truncation(PlateModel& plate, const modes::ModalModel& model, const Vec3& normal)
    : plate_(plate) {
  const bool moves = model.frequency.front() == 0;
  const double shift = moves ? first_elastic(model) : 0;
  if (moves) plate.stiffen(shift);
  for (const double f : model.frequency) stiffness_.push_back(square_of_omega(f) + shift);
  const std::vector<double> areas = plate.cell_areas();
  for (std::size_t c = 0; c < areas.size(); ++c)
    for (std::size_t m = 0; m < model.n_modes(); ++m)
      means_.push_back(areas[c] * along(model, model.face_shape, c, m, normal));
  solver_ = std::make_unique<linalg::LinearSolver>(
      "deflection beyond the modes", plate.stiffness(),
      linalg::LinearOptions{.method = linalg::LinearMethod::direct_symmetric});
}

void Truncation::look(std::span<const double> pressure) {
  const std::vector<double> load = plate_.load_of(pressure);
  std::vector<double> u(load.size(), 0), on_modes(stiffness_.size(), 0);
  if (std::ranges::all_of(load, [](double f) { return f == 0; })) return;
  solver_->solve(load, u);
  double all = 0;
  for (std::size_t i = 0; i < u.size(); ++i) all += load[i] * u[i];
  for (std::size_t c = 0; c < pressure.size(); ++c)
    for (std::size_t m = 0; m < on_modes.size(); ++m)
      on_modes[m] += pressure[c] * means_[c * on_modes.size() + m];
  double kept = 0;
  for (std::size_t m = 0; m < on_modes.size(); ++m) kept += on_modes[m] * on_modes[m] / stiffness_[m];
  sums_[0] += std::max(0.0, all - kept);
  sums_[1] += all;
}

std::vector<double> mesh_gaps(const modes::ModalModel& model, std::size_t cells, const Vec3& normal) {
  const std::vector<Vec3> areas = modes::face_areas(model);
  std::vector<double> gaps(model.n_modes(), 0);
  for (std::size_t m = 0; m < gaps.size(); ++m) {
    double apart = 0, all = 0;
    for (std::size_t f = 0; f < cells; ++f) {
      const double mean = along(model, model.face_shape, f, m, normal);
      double corners = 0;
      for (const Index v : model.faces[Index(f)])
        corners += along(model, model.vertex_shape, std::size_t(v), m, normal) /
                   double(model.faces[Index(f)].size());
      apart += areas[f].norm() * (corners - mean) * (corners - mean);
      all += areas[f].norm() * mean * mean;
    }
    gaps[m] = all > 0 ? std::sqrt(apart / all) : 1;
  }
  return gaps;
}

WithinFaces within_faces(const modes::ModalModel& model, const PressureLoad& load, double t) {
  WithinFaces seen;
  if (load.is_uniform()) return seen;
  const std::size_t n = model.n_modes();
  std::vector<double> middle(n, 0), fine(n, 0);
  const std::vector<Vec3> areas = modes::face_areas(model), centres = modes::face_centres(model);
  try {
    for (std::size_t f = 0; f < areas.size(); ++f) {
      const double at_middle = load.push(areas[f], centres[f], t);
      double mean = 0;
      for (const Vec3& x : points_within(model, model.faces[Index(f)]))
        mean += load.push(areas[f], x, t) / 16;
      if (at_middle == 0 && mean == 0) continue;
      for (std::size_t m = 0; m < n; ++m) {
        const double work = along(model, model.face_shape, f, m, areas[f]);
        middle[m] += at_middle * work;
        fine[m] += mean * work;
      }
    }
  } catch (const Error&) {
    return {};  // no value there: the scheme need not ask for it
  }
  double of_middle = 0;
  const double first = first_elastic(model);
  for (std::size_t m = 0; m < n; ++m) {
    const double weight = 1 / (square_of_omega(model.frequency[m]) + first);
    seen.apart += weight * (fine[m] - middle[m]) * (fine[m] - middle[m]);
    seen.size += weight * fine[m] * fine[m];
    of_middle += weight * middle[m] * middle[m];
  }
  seen.size = std::max(seen.size, of_middle);
  return seen;
}

LoadOnModes load_on_modes(const modes::ModalModel& model, const PressureLoad& load, double t) {
  const std::size_t n = model.n_modes();
  std::vector<double> part(n, 0), most(n, 0);
  const std::vector<Vec3> areas = modes::face_areas(model), centres = modes::face_centres(model);
  try {
    for (std::size_t f = 0; f < areas.size(); ++f) {
      const double pressure = load.push(areas[f], centres[f], t);
      if (pressure == 0) continue;
      for (std::size_t m = 0; m < n; ++m) {
        const double* u = model.face_shape.data() + 3 * f * n + m;
        const Vec3 shape(u[0], u[n], u[2 * n]);
        part[m] += pressure * shape.dot(areas[f]);
        most[m] += std::abs(pressure) * shape.norm() * areas[f].norm();
      }
    }
  } catch (const Error&) {
    return {};  // no value there: the scheme need not ask for it
  }
  LoadOnModes seen;
  for (std::size_t m = 0; m < n; ++m) seen.part += part[m] * part[m], seen.most += most[m] * most[m];
  return seen;
}

}  // namespace couplet::plate
