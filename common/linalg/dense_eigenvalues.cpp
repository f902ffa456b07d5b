// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/dense_eigenvalues.hpp"

#include <functional>

#include "common/base/error.hpp"

extern "C" {
void dsygv_(const int* type, const char* vectors, const char* half, const int* n, double* a,
            const int* rows_a, double* b, const int* rows_b, double* values, double* work, const int* n_work,
            int* info);
void dgeev_(const char* left, const char* right, const int* n, double* a, const int* rows_a, double* real,
            double* imaginary, double* left_vectors, const int* rows_left, double* right_vectors,
            const int* rows_right, double* work, const int* n_work, int* info);
}

namespace couplet::linalg {
namespace {

using Call = std::function<void(double* work, int n_work, int& info)>;

/// Queries LAPACK for the size of its workspace, then calls it.
void with_room(const char* name, int n, const Call& call) {
  int info = 0;
  double wanted = 0;
  call(&wanted, -1, info);
  std::vector<double> work(std::size_t(wanted) + 1);
  call(work.data(), int(work.size()), info);
  if (info != 0)
    throw Error("{} found no eigenvalues of a dense matrix of {} rows (info {}).", name, n, info);
}

}  // namespace

std::vector<double> symmetric_eigenvalues(std::vector<double> k, std::vector<double> m, int n) {
  std::vector<double> values(std::size_t(n), 0);
  if (n == 0) return values;
  const int type = 1;
  with_room("dsygv", n, [&](double* work, int n_work, int& info) {
    dsygv_(&type, "N", "L", &n, k.data(), &n, m.data(), &n, values.data(), work, &n_work, &info);
  });
  return values;
}

std::vector<std::complex<double>> general_eigenvalues(std::vector<double> a, int n) {
  std::vector<double> real(std::size_t(n), 0), imaginary(std::size_t(n), 0);
  if (n == 0) return {};
  const int one = 1;
  with_room("dgeev", n, [&](double* work, int n_work, int& info) {
    dgeev_("N", "N", &n, a.data(), &n, real.data(), imaginary.data(), nullptr, &one, nullptr, &one, work,
           &n_work, &info);
  });
  std::vector<std::complex<double>> values;
  for (std::size_t i = 0; i < real.size(); ++i) values.emplace_back(real[i], imaginary[i]);
  return values;
}

}  // namespace couplet::linalg
