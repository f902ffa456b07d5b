// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modal_model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace couplet {

std::vector<Vec3> face_centres(const ModalModel& model) {
  std::vector<Vec3> centres;
  for (Index f = 0; f < model.faces.size(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const Index v : model.faces[f]) centre += model.vertices[v];
    centres.push_back(centre / double(model.faces[f].size()));
  }
  return centres;
}

std::vector<Vec3> face_areas(const ModalModel& model) {
  std::vector<Vec3> areas;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto v = model.faces[f];
    const Vec3 a = model.vertices[v[2]] - model.vertices[v[0]];
    const Vec3 b = v.size() == 3 ? Vec3(model.vertices[v[2]] - model.vertices[v[1]])
                                 : Vec3(model.vertices[v[3]] - model.vertices[v[1]]);
    // A triangle: (x2 - x0) x (x2 - x1) / 2 has the sign of (x1 - x0) x (x2 - x0) / 2.
    areas.push_back(v.size() == 3 ? Vec3(0.5 * (model.vertices[v[1]] - model.vertices[v[0]]).cross(a))
                                  : Vec3(0.5 * a.cross(b)));
  }
  return areas;
}

void average_faces(ModalModel& model) {
  const std::size_t n = model.n_modes();
  model.face_shape.assign(std::size_t(model.faces.size()) * 3 * n, 0);
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (const Index v : corners)
      for (std::size_t i = 0; i < 3 * n; ++i)
        model.face_shape[std::size_t(f) * 3 * n + i] +=
            model.vertex_shape[std::size_t(v) * 3 * n + i] / double(corners.size());
  }
}

double largest_displacement(const ModalModel& model, std::size_t mode) {
  const std::size_t n = model.n_modes();
  double largest = 0;
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    const double* u = model.vertex_shape.data() + 3 * v * n + mode;
    largest = std::max(largest, Vec3(u[0], u[n], u[2 * n]).norm());
  }
  return largest;
}

std::string problem_of(const ModalModel& model) {
  const std::size_t n = model.n_modes(), vertices = model.vertices.size(), faces = model.faces.size();
  if (n == 0) return "it holds no mode";
  if (faces == 0) return "its surface has no face";
  for (std::size_t m = 0; m < n; ++m) {
    if (!std::isfinite(model.frequency[m]) || model.frequency[m] < 0)
      return fmt::format("the frequency of mode {} is {} Hz", m + 1, model.frequency[m]);
    if (m > 0 && model.frequency[m] < model.frequency[m - 1])
      return fmt::format("mode {} has a lower frequency than the mode before it", m + 1);
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
        return fmt::format("face {} names vertex {}; there are {}", f + 1, v, vertices);
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  for (const auto* values :
       {&model.vertex_shape, &model.face_shape, &model.participation, &model.face_density})
    if (!std::ranges::all_of(*values, finite)) return "it holds a value that is no number";
  return "";
}

}  // namespace couplet
