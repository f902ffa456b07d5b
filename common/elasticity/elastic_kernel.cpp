// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/elastic_kernel.hpp"

#include "common/elasticity/symmetric/symmetric_kernel.hpp"
#include "common/elasticity/thesis/least_squares.hpp"

namespace couplet::elastic {

ElasticKernel::ElasticKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, FaceGradientScheme scheme)
    : rows_(&rows), scheme_(scheme) {
  if (is_axisymmetric(rows) || is_symmetric())
    symmetric_ = std::make_unique<SymmetricKernel>(mesh, rows);
  else
    least_squares_ = std::make_unique<LeastSquares>(mesh, rows);
}

ElasticKernel::~ElasticKernel() = default;
ElasticKernel::ElasticKernel(ElasticKernel&&) noexcept = default;
ElasticKernel& ElasticKernel::operator=(ElasticKernel&&) noexcept = default;

SymmetricSpace& ElasticKernel::filled(std::span<const double> unknowns, std::span<const double> known) const {
  symmetric_->space().fill(unknowns, known);
  return symmetric_->space();
}

SymmetricSpace& ElasticKernel::cleared() const {
  symmetric_->space().clear_forces();
  return symmetric_->space();
}

void ElasticKernel::apply(std::span<const double> unknowns, std::span<const double> known,
                          std::span<double> result) const {
  symmetric_ ? apply_with_mass(unknowns, known, 0, true, result)
             : least_squares_->apply(unknowns, known, result);
}

void ElasticKernel::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                   const TakeGradient& take, Index first, Index end) const {
  if (!symmetric_) return least_squares_->face_gradients(unknowns, known, take, first, end);
  filled(unknowns, known);
  symmetric_->face_gradients(take, first, end);
}

void ElasticKernel::point_values(std::span<const double> unknowns, std::span<const double> known,
                                 std::span<double> points) const {
  symmetric_ ? filled(unknowns, known).point_values(points)
             : least_squares_->point_values(unknowns, known, points);
}

void ElasticKernel::face_means(std::span<const Index> faces, std::span<const double> unknowns,
                               std::span<const double> known, std::span<double> means) const {
  const SymmetricSpace& space = filled(unknowns, known);
  const int dim = space.mesh().dim;
  for (std::size_t i = 0; i < faces.size(); ++i)
    std::copy_n(space.face_mean(faces[i]).data(), dim, means.data() + i * std::size_t(dim));
}

Vec3 ElasticKernel::add_face_forces(std::span<const double> forces, std::span<double> rhs) const {
  if (!symmetric_) return rows_->add_forces(forces, rhs);
  SymmetricSpace& space = cleared();
  space.spread_face_forces(forces);
  space.add_collected(rhs);
  return space.acting(forces);
}

void ElasticKernel::add_cell_forces(std::span<const double> forces, std::span<double> rhs) const {
  if (!symmetric_) {
    for (std::size_t i = 0; i < forces.size(); ++i) rhs[i] += forces[i];
    return;
  }
  cleared().spread_cell_forces(forces);
  symmetric_->space().add_collected(rhs);
}

void ElasticKernel::add_pressure(std::span<const double> pressure, std::span<double> rhs) const {
  if (!symmetric_) return rows_->add_pressure(pressure, rhs);
  cleared();
  symmetric_->spread_pressure(pressure);
  symmetric_->space().add_collected(rhs);
}

bool ElasticKernel::set_density(std::span<const double> of_cells) const {
  if (symmetric_) symmetric_->space().set_density(of_cells);
  return symmetric_ != nullptr;
}

void ElasticKernel::apply_with_mass(std::span<const double> unknowns, std::span<const double> known,
                                    double mass_factor, bool with_stiffness, std::span<double> result) const {
  SymmetricSpace& space = filled(unknowns, known);
  space.clear_forces();
  if (with_stiffness) {
    symmetric_->add_internal_forces();
    space.add_springs(known);
  }
  if (mass_factor > 0) space.add_mass_forces(mass_factor);
  space.collect();
  space.take_rows(with_stiffness ? unknowns : std::span<const double>(), known, result);
}

/// Work of the forces of u on all nodes and points with the displacements v.
double ElasticKernel::product(ElasticPart part, const ElasticField& u, const ElasticField& v) const {
  if (!symmetric_) return 0;
  SymmetricSpace& space = filled(u.unknowns, u.known);
  space.clear_forces();
  if (part == ElasticPart::stiffness) symmetric_->add_internal_forces();
  if (part == ElasticPart::springs) space.add_springs(u.known);
  if (part == ElasticPart::mass) space.add_mass_forces(1);
  space.fill(v.unknowns, v.known);
  return space.work();
}

std::vector<Wrench> ElasticKernel::holding_forces(std::span<const double> unknowns,
                                                  std::span<const double> known,
                                                  const ElasticLoads& loads) const {
  if (!symmetric_) return {};
  SymmetricSpace& space = cleared();
  if (!loads.faces.empty()) space.spread_face_forces(loads.faces);
  if (!loads.cells.empty()) space.spread_cell_forces(loads.cells);
  if (!loads.pressure.empty()) symmetric_->spread_pressure(loads.pressure);
  space.negate_forces();
  space.fill(unknowns, known);
  symmetric_->add_internal_forces();
  // At a vertex shared with a support, the support carries the spring force along its known directions.
  space.add_springs(known);
  return space.held(known, false);
}

void ElasticKernel::apply_mixed(std::span<const double> unknowns, std::span<const double> pressure,
                                double mass_factor, std::span<double> result,
                                std::span<double> defect) const {
  SymmetricSpace& space = filled(unknowns, {});
  space.clear_forces();
  symmetric_->add_internal_forces(pressure, defect);
  space.add_springs({});
  if (mass_factor > 0) space.add_mass_forces(mass_factor);
  space.collect();
  space.take_rows(unknowns, {}, result);
}

}  // namespace couplet::elastic
