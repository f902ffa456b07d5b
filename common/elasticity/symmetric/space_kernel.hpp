// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/elasticity/elastic_kernel.hpp"
#include "common/elasticity/elastic_nodes.hpp"
#include "common/elasticity/symmetric/symmetric_space.hpp"

namespace couplet::elastic {

/// What kernels on a SymmetricSpace share: loads, mass, springs and supports act by its trial functions, stress by what a kernel
/// makes of its strain.
template <int D>
class SpaceKernel : public ElasticKernel::Implementation {
 public:
  SpaceKernel(const mesh::Mesh& mesh, const ElasticOperator& rows) : space_(mesh, rows) {}

  void apply(std::span<const double> unknowns, std::span<const double> known,
             std::span<double> result) override {
    apply_with_mass(unknowns, known, 0, true, result);
  }
  void apply_with_mass(std::span<const double> unknowns, std::span<const double> known, double mass_factor,
                       bool with_stiffness, std::span<double> result) override;
  double product(ElasticPart part, const ElasticField& u, const ElasticField& v) override;
  void point_values(std::span<const double> unknowns, std::span<const double> known,
                    std::span<double> points) override {
    space_.fill(unknowns, known);
    space_.visit_points([&](Index v) {
      std::copy_n(space_.points() + std::size_t(v) * SymmetricSpace<D>::stride, D,
                  points.data() + std::size_t(v) * D);
    });
  }
  bool set_density(std::span<const double> of_cells) override {
    space_.set_density(of_cells);
    return true;
  }
  Vec3 add_face_forces(std::span<const double> forces, std::span<double> rhs) override;
  void face_means(std::span<const Index> faces, std::span<const double> unknowns,
                  std::span<const double> known, std::span<double> means) override {
    space_.fill(unknowns, known);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Vec3 mean = face_mean(space_, faces[i]);
      std::copy_n(mean.data(), D, means.data() + i * D);
    }
  }
  void add_cell_forces(std::span<const double> forces, std::span<double> rhs) override;
  void add_pressure(std::span<const double> pressure, std::span<double> rhs) override;
  std::vector<Wrench> holding_forces(std::span<const double> unknowns, std::span<const double> known,
                                     const ElasticLoads& loads) override;

 protected:
  /// Adds those of the stress to the forces of the space, of its displacement.
  virtual void internal_forces() = 0;
  /// A pressure [Pa] on the flux faces as three-cornered ones share it with their edges.
  virtual std::vector<double> shared_pressure(std::span<const double> pressure) {
    return {pressure.begin(), pressure.end()};
  }
  /// Adds the forces of a pressure on the flux faces.
  void spread_pressure(std::span<const double> pressure);

  SymmetricSpace<D> space_;
};

}  // namespace couplet::elastic
