// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modal_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/modes/modal_model.hpp"

namespace couplet::modes {
namespace {

/// Modal mass and participation per axis, as visible on the surface: sums of face_density A |phi|^2 and
/// face_density A phi. Without face densities the mass is distributed evenly over the surface.
struct SurfaceSums {
  double modal_mass = 0, mass = 0;
  Vec3 participation = Vec3::Zero();
};
std::vector<SurfaceSums> surface_sums(const ModalModel& model) {
  const std::size_t n = model.n_modes();
  std::vector<SurfaceSums> sums(n);
  const std::vector<Vec3> areas = face_areas(model);
  double all = 0;
  for (const Vec3& area : areas) all += area.norm();
  for (std::size_t f = 0; f < areas.size(); ++f) {
    const double mass =
        areas[f].norm() * (model.face_density.empty() ? model.mass / all : model.face_density[f]);
    for (std::size_t m = 0; m < n; ++m) {
      const double* phi = model.face_shape.data() + 3 * f * n + m;
      const Vec3 shape(phi[0], phi[n], phi[2 * n]);
      sums[m].modal_mass += mass * shape.squaredNorm();
      sums[m].participation += mass * shape;
      sums[m].mass += mass;
    }
  }
  return sums;
}

/// Index of a mode whose face shape differs from that at the vertices, or -1. Shapes that vary strongly
/// within a face are skipped.
int mode_of_two_shapes(const ModalModel& model) {
  ModalModel by_vertices = model;
  average_faces(by_vertices);
  const std::size_t n = model.n_modes();
  for (std::size_t m = 0; m < n; ++m) {
    double square = 0, product = 0, corners = 0, told = 0;
    for (std::size_t i = m; i < model.face_shape.size(); i += n) {
      square += by_vertices.face_shape[i] * by_vertices.face_shape[i];
      product += by_vertices.face_shape[i] * model.face_shape[i];
      told += model.face_shape[i] * model.face_shape[i];
    }
    for (std::size_t i = m; i < model.vertex_shape.size(); i += n)
      corners += model.vertex_shape[i] * model.vertex_shape[i] / double(model.vertices.size());
    const bool smooth = square / double(model.faces.size()) > 0.25 * corners;
    if (smooth && (product < 0.3 * square || told > 3.5 * square)) return int(m);
  }
  return -1;
}

/// Roughness of a mode: sum over the edges of squared differences between their ends, relative to the sum of
/// squares. `row(vertex, component)` is the row of the shapes.
template <typename Row>
double roughness(const ModalModel& model, std::size_t mode, Row row) {
  const std::size_t n = model.n_modes();
  double differences = 0, squares = 0;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (std::size_t i = 0; i < corners.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const double a = model.vertex_shape[n * row(std::size_t(corners[i]), c) + mode];
        const double b =
            model.vertex_shape[n * row(std::size_t(corners[(i + 1) % corners.size()]), c) + mode];
        differences += (a - b) * (a - b);
        squares += a * a + b * b;
      }
  }
  return squares > 0 ? differences / squares : 0;
}

}  // namespace

std::string impossible_in(const ModalModel& model) {
  const std::size_t n = model.n_modes();
  if (!(model.mass > 0) || !std::isfinite(model.mass))
    return fmt::format("the mass of the structure is {} kg; it must be above 0", model.mass);
  for (std::size_t f = 0; f < model.face_density.size(); ++f)
    if (model.face_density[f] < 0)
      return fmt::format("the density of face {} is {} kg/m^2; it must not be negative", f + 1,
                         model.face_density[f]);
  for (std::size_t m = 0; m < n; ++m)
    if (largest_displacement(model, m) == 0)
      return fmt::format("the shape of mode {} is 0 everywhere", m + 1);
  for (std::size_t m = 0; m < n && model.frequency[m] == 0; ++m)
    if (const double misfit = rigid_motion(model, m).misfit; misfit > 0.02)
      return fmt::format(
          "mode {} has a frequency of 0 Hz, but its shape is not a rigid-body motion: a fraction {:.2g} of it (rms) is "
          "deformation. Check the array layout: one row per vertex, with three components",
          m + 1, misfit);
  if (const int m = mode_of_two_shapes(model); m >= 0)
    return fmt::format(
        "the shape of mode {} at the faces ('shape/faces') is not the mean of the shape at their vertices",
        m + 1);
  // Bessel's inequality: the norm of a uniform motion of the mass bounds its norm in the modes.
  for (int c = 0; c < 3; ++c) {
    double effective = 0;
    for (std::size_t m = 0; m < n; ++m) {
      effective += model.participation[c * n + m] * model.participation[c * n + m];
      if (effective > 1.01 * model.mass)
        return fmt::format(
            "the effective masses (participation^2) of modes 1 to {} along {} add up to {:.4g} kg, more "
            "than the total mass of {:.4g} kg",
            m + 1, "xyz"[c], effective, model.mass);
    }
  }
  return "";
}

/// Finds the largest cosine between two modes, which shows if they are orthogonal when the faces carry the
/// whole mass. It is 1 for equal modes and well below 0.5 for thick bodies, whose inside is not visible.
std::string overlap_problem_of(const ModalModel& model) {
  const std::size_t n = model.n_modes();
  const std::vector<Vec3> areas = face_areas(model);
  double mass = 0;
  std::vector<double> product(n * n, 0);
  for (std::size_t f = 0; f < model.face_density.size(); ++f) {
    const double own = model.face_density[f] * areas[f].norm();
    mass += own;
    for (std::size_t c = 0; c < 3; ++c) {
      const double* phi = model.face_shape.data() + (3 * f + c) * n;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) product[i * n + j] += own * phi[i] * phi[j];
    }
  }
  if (std::abs(mass - model.mass) > 0.01 * model.mass) return "";
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (const double both = product[i * n + i] * product[j * n + j];
          product[i * n + j] * product[i * n + j] > 0.25 * both)
        return fmt::format(
            "modes {} and {} are not orthogonal: the cosine of the angle between them is {:.2g}", j + 1,
            i + 1, std::abs(product[i * n + j]) / std::sqrt(both));
  return "";
}

std::string scale_problem_of(const ModalModel& model) {
  const std::vector<SurfaceSums> sums = surface_sums(model);
  // With densities the surface represents the nearby mass, otherwise its share of the motion.
  const double most = model.face_density.empty() ? 1e4 : 10;
  double largest = 0;
  for (std::size_t m = 0; m < sums.size(); ++m) {
    largest = std::max(largest, sums[m].modal_mass);
    if (sums[m].modal_mass > most)
      return fmt::format(
          "mode {} is not mass-normalized: the surface alone has a modal mass of {:.3g} kg, but that of the whole structure "
          "must be 1 kg",
          m + 1, sums[m].modal_mass);
    if (model.face_density.empty() || sums[m].mass < 0.5 * model.mass) continue;
    for (int c = 0; c < 3; ++c) {
      const double told = model.participation[c * sums.size() + m], seen = sums[m].participation[c];
      // If the faces carry the whole mass, they show the participation up to slopes over half the thickness.
      const bool whole = std::abs(sums[m].mass - model.mass) < 0.01 * model.mass;
      const bool apart = std::abs(told - seen) > 0.2 * std::sqrt(model.mass) + 0.3 * std::abs(told);
      // Small values are differences of large contributions, which a surface need not show.
      const bool small = told * told < 0.05 * model.mass && seen * seen < 0.3 * model.mass;
      if (!(whole && apart) && (small || (seen / told > 0.3 && seen / told < 3))) continue;
      return fmt::format(
          "the participation of mode {} along {} is {:.3g} sqrt(kg), but the shape and mass of the surface "
          "give {:.3g}: shapes and participation are from different modes",
          m + 1, "xyz"[c], told, seen);
    }
  }
  const double least =
      model.face_density.empty() ? 1e-4 : (sums.front().mass < 0.5 * model.mass ? 1e-4 : 0.1);
  if (largest < least)
    return fmt::format(
        "no mode is mass-normalized: the surface has modal masses of up to {:.2g} kg, but that of the whole structure must be "
        "1 kg",
        largest);
  return "";
}

std::string problem_of(const ModalModel& model) {
  const std::size_t n = model.n_modes(), vertices = model.vertices.size(), faces = model.faces.size();
  if (n == 0) return "it contains no modes";
  if (faces == 0) return "its surface has no faces";
  for (std::size_t m = 0; m < n; ++m) {
    if (!std::isfinite(model.frequency[m]) || model.frequency[m] < 0)
      return fmt::format("the frequency of mode {} is {} Hz", m + 1, model.frequency[m]);
    if (m > 0 && model.frequency[m] < model.frequency[m - 1])
      return fmt::format("mode {} has a lower frequency than the previous mode", m + 1);
  }
  if (model.vertex_shape.size() != vertices * 3 * n)
    return fmt::format("the shapes have {} values; {} vertices x 3 components x {} modes are needed",
                       model.vertex_shape.size(), vertices, n);
  if (model.face_shape.size() != faces * 3 * n)
    return fmt::format(
        "the shapes at the faces have {} values; {} faces x 3 components x {} modes are needed",
        model.face_shape.size(), faces, n);
  if (model.participation.size() != 3 * n)
    return fmt::format("the participation has {} values; 3 components x {} modes are needed",
                       model.participation.size(), n);
  for (std::size_t f = 0; f < faces; ++f) {
    const auto corners = model.faces[Index(f)];
    if (corners.size() != 3 && corners.size() != 4)
      return fmt::format("face {} has {} vertices; 3 or 4 are needed", f + 1, corners.size());
    for (const Index v : corners)
      if (v < 0 || std::size_t(v) >= vertices)
        return fmt::format("face {} refers to vertex {}, but the number of vertices is {}", f + 1, v,
                           vertices);
  }
  if (std::string wrong = surface_problem_of(model); !wrong.empty()) return wrong;
  const auto finite = [](double value) { return std::isfinite(value); };
  for (const auto* values :
       {&model.vertex_shape, &model.face_shape, &model.participation, &model.face_density})
    if (!std::ranges::all_of(*values, finite)) return "it contains a value that is not finite";
  return "";
}

std::string order_problem_of(const ModalModel& model) {
  // The lowest flexible mode is the smoothest. Higher ones may alternate between vertices.
  const auto lowest = std::size_t(std::ranges::find_if(model.frequency, [](double f) { return f > 0; }) -
                                  model.frequency.begin());
  if (lowest == model.n_modes()) return "";
  const std::size_t n = model.vertices.size();
  const double by_vertex = roughness(model, lowest, [](std::size_t v, std::size_t c) { return 3 * v + c; });
  const double by_component =
      roughness(model, lowest, [n](std::size_t v, std::size_t c) { return c * n + v; });
  if (by_component >= 0.5 * by_vertex) return "";
  return fmt::format(
      "the shape of mode {} seems to list all x components first, then all y, then all z: in this order, the mean square "
      "difference of neighboring vertices is {:.2g} times smaller. There must be one row per vertex, with three components",
      lowest + 1, by_vertex / std::max(by_component, 1e-12 * by_vertex));
}

}  // namespace couplet::modes
