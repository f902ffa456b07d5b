// SPDX-License-Identifier: Apache-2.0
#include "common/fv/elastic_kernel.hpp"

#include "common/fv/elastic_nodes.hpp"

namespace couplet {

ElasticKernel::ElasticKernel(const Mesh& mesh, const ElasticOperator& rows, FaceGradientScheme scheme)
    : scheme_(scheme),
      implementation_(scheme == FaceGradientScheme::thesis ? make_thesis_kernel(mesh, rows)
                                                           : make_corrected_kernel(mesh, rows)) {}

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

}  // namespace couplet
