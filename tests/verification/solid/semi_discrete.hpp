// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>

#include "tests/verification/solid/support.hpp"

namespace couplet::testing {

/// The equations in time that the solid's schemes integrate, on one rank: the cells' accelerations as a dense
/// linear function, massless faces eliminated. Errors against their exact solution hold no error of space.
class SemiDiscrete {
 public:
  explicit SemiDiscrete(const Solid& solid) : solid_(solid) {
    const elastic::ElasticOperator& elastic = solid.body().elastic();
    const auto n = Eigen::Index(elastic.n_unknowns());
    n_ = Eigen::Index(solid.body().mesh().cells.n_owned()) * solid.body().mesh().dim;
    const linalg::SparseMatrix matrix = elastic.matrix({});
    Eigen::MatrixXd a(n, n);
    std::vector<double> unit(n, 0), column(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      unit[j] = 1;
      matrix.multiply(unit, column);
      a.col(j) = Eigen::Map<Eigen::VectorXd>(column.data(), n);
      unit[j] = 0;
    }
    to_cells_ = a.topRightCorner(n_, n - n_) * a.bottomRightCorner(n - n_, n - n_).inverse();
    stiffness_ = a.topLeftCorner(n_, n_) - to_cells_ * a.bottomLeftCorner(n - n_, n_);
    mass_.resize(n_);
    for (Eigen::Index i = 0; i < n_; ++i)
      mass_[i] = solid.body().parameters().material.density *
                 solid.body().geometry().volume[i / solid.body().mesh().dim];
  }

  Eigen::Index size() const { return n_; }
  const Eigen::MatrixXd& stiffness() const { return stiffness_; }
  const Eigen::VectorXd& mass() const { return mass_; }

  /// Forces on the cells that stand for a right-hand side of all rows.
  Eigen::VectorXd reduced(const std::vector<double>& rhs) const {
    const Eigen::Map<const Eigen::VectorXd> all(rhs.data(), Eigen::Index(rhs.size()));
    return all.head(n_) - to_cells_ * all.tail(all.size() - n_);
  }

  /// Displacements of the cells at `end` from their state at 0 under `force(t)`, with Rayleigh damping:
  /// classical Runge-Kutta, steps short enough to be exact here.
  Eigen::VectorXd integrate(const std::function<Eigen::VectorXd(double)>& force, const SolidDamping& damping,
                            double end, int steps) const {
    Eigen::VectorXd u = start(solid_.stepper().state().cell_u), v = start(solid_.stepper().state().cell_v);
    const auto acceleration = [&](double t, const Eigen::VectorXd& x, const Eigen::VectorXd& rate) {
      return Eigen::VectorXd((force(t) - stiffness_ * (x + damping.stiffness * rate)).cwiseQuotient(mass_) -
                             damping.mass * rate);
    };
    const double h = end / steps;
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const Eigen::VectorXd k1 = acceleration(t, u, v), v2 = v + h / 2 * k1;
      const Eigen::VectorXd k2 = acceleration(t + h / 2, u + h / 2 * v, v2), v3 = v + h / 2 * k2;
      const Eigen::VectorXd k3 = acceleration(t + h / 2, u + h / 2 * v2, v3), v4 = v + h * k3;
      const Eigen::VectorXd k4 = acceleration(t + h, u + h * v3, v4);
      u += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
      v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return u;
  }

 private:
  Eigen::VectorXd start(const std::vector<double>& cells) const {
    return Eigen::Map<const Eigen::VectorXd>(cells.data(), n_);
  }

  const Solid& solid_;
  Eigen::Index n_ = 0;
  Eigen::MatrixXd to_cells_, stiffness_;
  Eigen::VectorXd mass_;
};

}  // namespace couplet::testing
