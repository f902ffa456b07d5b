// SPDX-License-Identifier: Apache-2.0
#include "common/elasticity/elastic_kernel.hpp"

#include "common/elasticity/elastic_nodes.hpp"

namespace couplet::elastic {

ElasticKernel::ElasticKernel(const mesh::Mesh& mesh, const ElasticOperator& rows, FaceGradientScheme scheme)
    : rows_(&rows),
      scheme_(scheme),
      implementation_(is_axisymmetric(rows)                     ? make_axisymmetric_kernel(mesh, rows)
                      : scheme == FaceGradientScheme::thesis    ? make_thesis_kernel(mesh, rows)
                      : scheme == FaceGradientScheme::corrected ? make_corrected_kernel(mesh, rows)
                                                                : make_symmetric_kernel(mesh, rows)) {}

ElasticKernel::~ElasticKernel() = default;
ElasticKernel::ElasticKernel(ElasticKernel&&) noexcept = default;
ElasticKernel& ElasticKernel::operator=(ElasticKernel&&) noexcept = default;

void ElasticKernel::apply(std::span<const double> unknowns, std::span<const double> known,
                          std::span<double> result) const {
  implementation_->apply(unknowns, known, result);
}

void ElasticKernel::face_gradients(std::span<const double> unknowns, std::span<const double> known,
                                   const TakeGradient& take, Index first, Index end) const {
  implementation_->face_gradients(unknowns, known, take, first, end);
}

void ElasticKernel::point_values(std::span<const double> unknowns, std::span<const double> known,
                                 std::span<double> points) const {
  implementation_->point_values(unknowns, known, points);
}

Vec3 ElasticKernel::add_face_forces(std::span<const double> forces, std::span<double> rhs) const {
  return is_symmetric() ? implementation_->add_face_forces(forces, rhs) : rows_->add_forces(forces, rhs);
}

void ElasticKernel::face_means(std::span<const Index> faces, std::span<const double> unknowns,
                               std::span<const double> known, std::span<double> means) const {
  implementation_->face_means(faces, unknowns, known, means);
}

void ElasticKernel::add_cell_forces(std::span<const double> forces, std::span<double> rhs) const {
  if (is_symmetric()) return implementation_->add_cell_forces(forces, rhs);
  for (std::size_t i = 0; i < forces.size(); ++i) rhs[i] += forces[i];
}

void ElasticKernel::add_pressure(std::span<const double> pressure, std::span<double> rhs) const {
  if (is_symmetric()) return implementation_->add_pressure(pressure, rhs);
  rows_->add_pressure(pressure, rhs);
}

bool ElasticKernel::set_density(std::span<const double> of_cells) const {
  return implementation_->set_density(of_cells);
}

void ElasticKernel::apply_with_mass(std::span<const double> unknowns, std::span<const double> known,
                                    double mass_factor, bool with_stiffness, std::span<double> result) const {
  implementation_->apply_with_mass(unknowns, known, mass_factor, with_stiffness, result);
}

double ElasticKernel::product(ElasticPart part, const ElasticField& u, const ElasticField& v) const {
  return implementation_->product(part, u, v);
}

std::vector<Wrench> ElasticKernel::holding_forces(std::span<const double> unknowns,
                                                  std::span<const double> known,
                                                  const ElasticLoads& loads) const {
  return implementation_->holding_forces(unknowns, known, loads);
}

void ElasticKernel::apply_mixed(std::span<const double> unknowns, std::span<const double> pressure,
                                double mass_factor, std::span<double> result,
                                std::span<double> defect) const {
  implementation_->apply_mixed(unknowns, pressure, mass_factor, result, defect);
}

}  // namespace couplet::elastic
