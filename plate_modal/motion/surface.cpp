// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/surface.hpp"

#include <numbers>
#include <utility>

namespace couplet::plate {

Surface::Surface(modes::ModalModel model)
    : model_(std::move(model)), centres_(modes::face_centres(model_)), areas_(modes::face_areas(model_)) {
  for (const double frequency : model_.frequency) omega_.push_back(2 * std::numbers::pi * frequency);
}

std::vector<double> Surface::participation(const Vec3& direction) const {
  std::vector<double> result(omega_.size());
  for (std::size_t m = 0; m < omega_.size(); ++m)
    for (int c = 0; c < 3; ++c)
      result[m] += direction[c] * model_.participation[std::size_t(c) * omega_.size() + m];
  return result;
}

// Midpoint rule of thesis 4.5.1: the force of a face acts on the mode at the face.
void Surface::add_load(std::span<const double> force, std::span<double> load) const {
  const std::size_t n = omega_.size();
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (force[i] == 0) continue;
    const double* shape = model_.face_shape.data() + i * n;
    for (std::size_t m = 0; m < n; ++m) load[m] += force[i] * shape[m];
  }
}

std::vector<double> Surface::motion(std::span<const double> q) const {
  std::vector<double> all(3 * model_.vertices.size(), 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double* shape = model_.vertex_shape.data() + i * omega_.size();
    for (std::size_t m = 0; m < omega_.size(); ++m) all[i] += shape[m] * q[m];
  }
  return all;
}

coupling::Interface Surface::describe() const {
  coupling::Interface interface;
  interface.dim = 3;
  interface.vertices = model_.vertices;
  interface.face_centres = centres_;
  interface.face_areas = areas_;
  interface.face_offset = model_.faces.offset;
  interface.face_vertices = model_.faces.index;
  return interface;
}

}  // namespace couplet::plate
