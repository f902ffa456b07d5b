// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

/// Eigenvalues of dense matrices, n x n by columns, by LAPACK. Throws Error where it does not converge.
namespace couplet::linalg {

/// Of K x = lambda M x, smallest first. Both symmetric, M positive definite; only their lower halves are read.
std::vector<double> symmetric_eigenvalues(std::vector<double> k, std::vector<double> m, int n);

/// Of any real matrix, in no order.
std::vector<std::complex<double>> general_eigenvalues(std::vector<double> a, int n);

}  // namespace couplet::linalg
