// SPDX-License-Identifier: Apache-2.0
#include "common/linalg/idr.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "common/linalg/dot.hpp"
#include "common/log/life.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::linalg {
namespace {

// The step that lessens the residual most makes the recurrence inexact where it turns it by nearly 90 degrees
// (van Gijzen and Sonneveld's value for the cosine).
constexpr double least_cosine = 0.7;

void add(double factor, std::span<const double> v, std::span<double> to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * v[i];
}

}  // namespace

Idr::Idr(MPI_Comm comm, std::size_t n) : comm_(comm), v_(n), z_(n) {
  std::mt19937 random(static_cast<unsigned>(parallel::comm_rank(comm)));
  for (auto& p : shadow_) {
    p.resize(n);
    for (float& value : p)
      value = static_cast<float>(random()) / static_cast<float>(std::mt19937::max()) - 0.5F;
  }
}

void Idr::run(const LinearMap& apply, const LinearMap& precondition, std::span<double> r, std::span<double> x,
              double wanted, int most, int& applications) {
  const auto over_ranks = [&](double* values, int count) {
    MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, comm_);
  };
  const auto norm = [&](std::span<const double> v) {
    return std::sqrt(parallel::sum(comm_, dot_here(v, v)));
  };
  for (int k = 0; k < s; ++k) {
    images_[k].assign(r.size(), 0);
    directions_[k].assign(r.size(), 0);
  }
  Eigen::Matrix<double, s, s> m = Eigen::Matrix<double, s, s>::Identity();  // shadow^T images, lower triangle
  double omega = 1;
  while (applications < most) {
    log::alive();
    Eigen::Matrix<double, s, 1> f;
    for (int i = 0; i < s; ++i) f[i] = dot_here(shadow_[i], r);
    over_ranks(f.data(), s);
    for (int k = 0; k < s; ++k) {
      Eigen::Matrix<double, s, 1> c = Eigen::Matrix<double, s, 1>::Zero();
      c.tail(s - k) = m.bottomRightCorner(s - k, s - k).triangularView<Eigen::Lower>().solve(f.tail(s - k));
      if (!c.allFinite()) return;
      std::copy(r.begin(), r.end(), v_.begin());
      for (int i = k; i < s; ++i) add(-c[i], images_[i], v_);
      precondition(v_, z_);
      for (double& value : z_) value *= omega;
      for (int i = k; i < s; ++i) add(c[i], directions_[i], z_);
      std::swap(directions_[k], z_);
      apply(directions_[k], images_[k]);
      ++applications;
      for (int i = 0; i < k; ++i) {
        const double along = parallel::sum(comm_, dot_here(shadow_[i], images_[k]));
        add(-along / m(i, i), images_[i], images_[k]);
        add(-along / m(i, i), directions_[i], directions_[k]);
      }
      for (int i = k; i < s; ++i) m(i, k) = dot_here(shadow_[i], images_[k]);
      over_ranks(&m(k, k), s - k);
      const double beta = f[k] / m(k, k);
      if (!std::isfinite(beta)) return;
      add(-beta, images_[k], r);
      add(beta, directions_[k], x);
      if (norm(r) <= wanted) return;
      for (int i = k + 1; i < s; ++i) f[i] -= beta * m(i, k);
    }
    precondition(r, z_);
    apply(z_, v_);
    ++applications;
    std::array<double, 3> products = {dot_here(v_, r), dot_here(v_, v_), dot_here(r, r)};
    over_ranks(products.data(), 3);
    const auto [tr, tt, rr] = products;
    const double cosine = std::abs(tr) / std::sqrt(tt * rr);
    omega = tr / tt;
    if (cosine < least_cosine) omega *= least_cosine / cosine;
    if (!std::isfinite(omega) || omega == 0) return;
    add(-omega, v_, r);
    add(omega, z_, x);
    if (norm(r) <= wanted) return;
  }
}

}  // namespace couplet::linalg
