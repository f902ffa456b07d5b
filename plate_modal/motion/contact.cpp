// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/motion/contact.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/contact/contact.hpp"
#include "common/fv/expression.hpp"

namespace couplet::plate {
namespace {

/// A face is oriented towards the seat if its normal is within 60 degrees of the direction.
constexpr double least_cosine_to_seat = 0.5;

}  // namespace

Contact::Contact(const Surface& surface, const ContactParameters& p, const Vec3& normal, double stiffness)
    : rule_(p.rule), n_modes_(surface.n_modes()) {
  const Vec3 direction = p.direction.empty() ? normal : Vec3(p.direction[0], p.direction[1], p.direction[2]);
  std::vector<std::size_t> faces;
  const fv::Expression height(p.height, "contact.height"), where(p.where, "contact.where");
  for (std::size_t f = 0; f < surface.n_faces(); ++f) {
    const Vec3 &x = surface.centres()[f], &area = surface.areas()[f];
    const double towards = -area.dot(direction);
    if (towards < least_cosine_to_seat * area.norm() || !(where(x, 0) > 0)) continue;
    faces.push_back(f);
    centre_.push_back(x);
    gap_.push_back(x.dot(direction) - height(x, 0) - 0.5 * p.opening);
    kappa_.push_back(p.stiffness.value_or(p.scale * stiffness) * towards);
    for (int m = 0; m < n_modes_; ++m) {
      double along = 0;
      for (int c = 0; c < 3; ++c)
        along += direction[c] * surface.face_shape(f)[std::size_t(c) * n_modes_ + m];
      shape_.push_back(along);
    }
  }
  if (gap_.empty())
    throw Error("contact: no face of the structure points toward the seat. Check 'direction' and 'where'.");
  refuse_sliding(surface, direction, faces);
}

/// A seat acts along its direction. Faces that modes only move across it (the rim of a plate next to a seat)
/// would penetrate it without any effective force.
void Contact::refuse_sliding(const Surface& surface, const Vec3& direction,
                             std::span<const std::size_t> faces) const {
  double moves[2] = {0, 0};  // along the direction, in all
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto shape = surface.face_shape(faces[i]);
    for (int m = 0; m < n_modes_; ++m) {
      const double along = shape_[i * n_modes_ + m];
      moves[0] += kappa_[i] * along * along;
      for (int c = 0; c < 3; ++c) {
        const double one = shape[std::size_t(c) * n_modes_ + m];
        moves[1] += kappa_[i] * one * one;
      }
    }
  }
  const double cosine = std::sqrt(moves[0] / moves[1]);
  if (cosine >= least_cosine_to_seat) return;
  throw Error(
      "contact.direction: the modes move the faces toward the seat along ({:g}, {:g}, {:g}) by only {:.0f} % of their motion; "
      "at least {:.0f} % is needed for contact. The motion must be toward the seat.",
      direction.x(), direction.y(), direction.z(), moves[1] > 0 ? 100 * cosine : 0,
      100 * least_cosine_to_seat);
}

Contact::DeepestPoint Contact::deepest(std::span<const double> q) const {
  DeepestPoint deepest{-std::numeric_limits<double>::infinity()};
  for (std::size_t f = 0; f < gap_.size(); ++f)
    if (const double delta = penetration(f, q); delta > deepest.depth) deepest = {delta, centre_[f]};
  return deepest;
}

double Contact::stiffness_of_impact(std::span<const double> from, std::span<const double> q,
                                    const Eigen::VectorXd& force) const {
  double seen = 0;
  for (std::size_t f = 0; f < gap_.size(); ++f) {
    if (!(std::max(penetration(f, from), penetration(f, q)) > 0)) continue;
    const double along = Eigen::Map<const Eigen::VectorXd>(shape_.data() + f * n_modes_, n_modes_).dot(force);
    seen += kappa_[f] * along * along;
  }
  const double square = force.squaredNorm();
  return square > 0 ? seen / square : 0;
}

double Contact::largest_stiffness() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n_modes_, n_modes_);
  for (std::size_t f = 0; f < gap_.size(); ++f)
    all.selfadjointView<Eigen::Lower>().rankUpdate(
        Eigen::Map<const Eigen::VectorXd>(shape_.data() + f * n_modes_, n_modes_), kappa_[f]);
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(all, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

double Contact::penetration(std::size_t face, std::span<const double> q) const {
  const double* shape = shape_.data() + face * n_modes_;
  double delta = -gap_[face];
  for (int m = 0; m < n_modes_; ++m) delta -= shape[m] * q[m];
  return delta;
}

void Contact::evaluate(std::span<const double> from, std::span<const double> q, ContactResult& r) const {
  const int n = n_modes_;
  r.force.setZero(n);
  r.tangent.setZero(n, n);
  for (std::size_t f = 0; f < gap_.size(); ++f) {
    const double now = penetration(f, q);
    const auto [force, slope] =
        is_conserving() ? couplet::contact::push(penetration(f, from), now) : couplet::contact::push(now);
    if (force == 0) continue;
    const Eigen::Map<const Eigen::VectorXd> shape(shape_.data() + f * n, n);
    r.force += kappa_[f] * force * shape;
    r.tangent.selfadjointView<Eigen::Lower>().rankUpdate(shape, kappa_[f] * slope);
  }
  r.tangent.triangularView<Eigen::StrictlyUpper>() = r.tangent.transpose();
}

void Contact::find(std::span<const double> q, ContactResult& r) const {
  r.energy = r.total = r.penetration = 0;
  for (std::size_t f = 0; f < gap_.size(); ++f) {
    const double delta = penetration(f, q);
    if (!(delta > 0)) continue;
    r.energy += 0.5 * kappa_[f] * delta * delta;
    r.total += kappa_[f] * delta;
    r.penetration = std::max(r.penetration, delta);
  }
}

}  // namespace couplet::plate
