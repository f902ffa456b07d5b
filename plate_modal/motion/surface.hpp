// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "common/coupling/participant.hpp"
#include "common/modes/modal_model.hpp"

namespace couplet::plate {

/// Modal model as loads and motion see it. Every rank stores all of it and computes the same, so that results
/// do not depend on the number of ranks. The cost is dominated by rank 0, which distributes forces.
class Surface final {
 public:
  explicit Surface(modes::ModalModel model);

  const modes::ModalModel& model() const { return model_; }
  int n_modes() const { return static_cast<int>(omega_.size()); }
  const std::vector<double>& omega() const { return omega_; }
  /// Integral of rho phi dV . direction, per mode.
  std::vector<double> participation(const Vec3& direction) const;

  std::size_t n_faces() const { return centres_.size(); }
  const std::vector<Vec3>& centres() const { return centres_; }
  const std::vector<Vec3>& areas() const { return areas_; }
  /// Shapes of a face: component c, mode m at [c modes + m].
  std::span<const double> face_shape(std::size_t face) const {
    const std::size_t n = 3 * omega_.size();
    return {model_.face_shape.data() + face * n, n};
  }

  /// Adds the sum of force . phi over the faces to `load` (modes); `force`: 3 values per face [N].
  void add_load(std::span<const double> force, std::span<double> load) const;
  /// sum q_m phi_m at the vertices, 3 each.
  std::vector<double> motion(std::span<const double> q) const;
  /// Places and areas; takes and gives remain empty.
  coupling::Interface describe() const;

 private:
  modes::ModalModel model_;
  std::vector<double> omega_;
  std::vector<Vec3> centres_, areas_;
};

}  // namespace couplet::plate
