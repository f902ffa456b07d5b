// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "solid_solver/body/solid_body.hpp"

namespace couplet::solid {

/// y = A x on the packed rows of this rank (owned cells, then unknown faces). Collective.
using ElasticApplication = std::function<void(std::span<const double> x, std::span<double> y)>;

/// Largest number of cell displacement components for a spectrum, because the matrix is dense.
constexpr GlobalIndex largest_spectrum = 4000;

/// Eigenvalues of M^-1 K [1/s^2], ascending real part. K is A with massless faces eliminated, M contains
/// `cell_mass`, one per owned cell [kg]. On rank 0, empty elsewhere. Throws Error beyond largest_spectrum.
/// Collective.
std::vector<std::complex<double>> spectrum(const mesh::Mesh& mesh, std::span<const double> cell_mass,
                                           std::size_t n_unknowns, const ElasticApplication& apply);

/// Eigenvalues of a symmetric pair, M applied like A: real, ascending. Massless rows are eliminated.
/// Collective.
std::vector<std::complex<double>> symmetric_spectrum(const mesh::Mesh& mesh, std::size_t n_unknowns,
                                                     const ElasticApplication& stiffness,
                                                     const ElasticApplication& mass);

/// Eigenvalues of a body, see above. Collective.
std::vector<std::complex<double>> eigenvalues(const SolidBody& body);

}  // namespace couplet::solid
