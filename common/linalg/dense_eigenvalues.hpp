// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

/// Eigenvalues of dense matrices, n x n by columns, by LAPACK. Throws Error if it does not converge.
namespace couplet::linalg {

/// Eigenvalues of K x = lambda M x, ascending. K is symmetric, M positive definite. Reads only lower halves.
std::vector<double> symmetric_eigenvalues(std::vector<double> k, std::vector<double> m, int n);

/// Eigenvalues of any real matrix, unsorted.
std::vector<std::complex<double>> general_eigenvalues(std::vector<double> a, int n);

}  // namespace couplet::linalg
