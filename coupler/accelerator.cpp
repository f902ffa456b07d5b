// SPDX-License-Identifier: Apache-2.0
#include "coupler/accelerator.hpp"

#include <cassert>

#include "coupler/quasi_newton.hpp"
#include "coupler/relaxation.hpp"

namespace couplet {

void sum_over(MPI_Comm comm, std::span<double> values) {
  MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm);
}

double dot(std::span<const double> a, std::span<const double> b) {
  assert(a.size() == b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::unique_ptr<Accelerator> make_accelerator(const AccelerationParameters& parameters, MPI_Comm comm) {
  switch (parameters.type) {
    case AccelerationParameters::Type::constant:
      return std::make_unique<ConstantRelaxation>(parameters.initial_relaxation);
    case AccelerationParameters::Type::aitken:
      return std::make_unique<AitkenRelaxation>(parameters, comm);
    case AccelerationParameters::Type::iqn_ils:
      return std::make_unique<LeastSquaresNewton>(parameters, comm);
    case AccelerationParameters::Type::iqn_mvj:
      return std::make_unique<MultiVectorNewton>(parameters, comm);
  }
  return nullptr;
}

}  // namespace couplet
