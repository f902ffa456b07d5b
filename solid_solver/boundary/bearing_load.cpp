// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/bearing_load.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/boundary/distributed_force.hpp"

namespace couplet::solid {
namespace {

// Mean squares of normals along the axis, which the facets of a coarse cylinder still have, and across it, which a
// strip of a cylinder of 40 degrees has.
constexpr double along_axis = 0.02, curved = 0.04;
// Share of a force that may go along the axis found from such facets.
constexpr double most_axial = 0.05;
// Rounds until the loaded half fits the pressure; mostly it is one.
constexpr int most_rounds = 20;

}  // namespace

BearingLoad::BearingLoad(const mesh::Mesh& mesh, const mesh::Geometry& geometry, std::vector<Index> faces,
                         const TotalLoad& load, std::string where)
    : mesh_(&mesh),
      geometry_(&geometry),
      where_(std::move(where)),
      faces_(std::move(faces)),
      force_(fv::make_expressions(load.force, mesh.dim, where_ + ".force")) {
  find_axis();
  for (const Index f : faces_) {
    const Vec3& n = geometry.face_area[f];
    across_.push_back((n - n.dot(axis_) * axis_).normalized());
  }
}

void BearingLoad::find_axis() {
  Tensor3 spread = Tensor3::Zero();
  double area = 0;
  for (const Index f : faces_) {
    const Vec3& n = geometry_->face_area[f];
    spread += n * n.transpose() / n.norm();
    area += n.norm();
  }
  area_ = parallel::sum(mesh_->comm, area);
  if (!(area_ > 0)) throw Error("{}: the faces with this load have zero area.", where_);
  const Eigen::SelfAdjointEigenSolver<Tensor3> axes(Tensor3(sum_of(mesh_->comm, spread) / area_));
  if (!(axes.eigenvalues()[1] > curved))
    throw Error(
        "{}: these faces are nearly flat, but a bearing load requires a full or half cylinder; use 'type: "
        "force' or 'remote-load'.",
        where_);
  if (axes.eigenvalues()[0] > along_axis)
    throw Error(
        "{}: these faces are not a cylinder: their normals point along all three axes. Put only the hole "
        "into the patch, or select its faces by 'parts'.",
        where_);
  if (mesh_->dim == 3) axis_ = axes.eigenvectors().col(0);
}

Vec3 BearingLoad::force_at(double t) const {
  Vec3 force = Vec3::Zero();
  for (int a = 0; a < mesh_->dim; ++a) force[a] = force_[std::size_t(a)](Vec3::Zero(), t);
  if (std::abs(force.dot(axis_)) > most_axial * force.norm())
    throw Error(
        "{}.force: {:.2g} of the force acts along the axis ({:.3g}, {:.3g}, {:.3g}) of the cylinder, where "
        "a pin slides; apply that part as a 'force' or 'remote-load' to a shoulder.",
        where_, std::abs(force.dot(axis_)) / force.norm(), axis_[0], axis_[1], axis_[2]);
  return force;
}

/// q: see the class. Rounds until the half chosen by the force is the one where the pressure is positive.
BearingLoad::Push BearingLoad::find_push(const Vec3& force) const {
  const Vec3 wanted = force - force.dot(axis_) * axis_;
  Vec3 push = wanted;
  for (int round = 0; round < most_rounds; ++round) {
    Tensor3 spread = Tensor3::Zero();
    for (std::size_t i = 0; i < faces_.size(); ++i)
      if (push.dot(across_[i]) < 0)
        spread += geometry_->face_area[faces_[i]].norm() * across_[i] * across_[i].transpose();
    spread = sum_of(mesh_->comm, spread);
    const Eigen::SelfAdjointEigenSolver<Tensor3> axes(spread);
    if (!(axes.eigenvalues()[1] > 1e-3 * area_ * curved))
      throw Error("{}.force: no half of the cylinder faces the force ({:g}, {:g}, {:g}) N; reverse its sign?",
                  where_, force[0], force[1], force[2]);
    Vec3 better = Vec3::Zero();  // across the axis, along which there is nothing
    for (int k = 1; k < 3; ++k) {
      const Vec3 e = axes.eigenvectors().col(k);
      better += e * e.dot(wanted) / axes.eigenvalues()[k];
    }
    bool fits = true;
    for (const Vec3& m : across_) fits = fits && (push.dot(m) < 0) == (better.dot(m) < 0);
    if (!parallel::any(mesh_->comm, !fits) || round + 1 == most_rounds) return {push, better};
    push = better;
  }
  return {push, push};
}

void BearingLoad::add_forces(double t, std::span<double> forces) const {
  const Vec3 force = force_at(t);
  if (force.isZero(0)) return;
  const int dim = mesh_->dim;
  const Push push = find_push(force);
  const Vec3 along = force.dot(axis_) / area_ * axis_;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    Vec3 traction = along;
    if (push.half.dot(across_[i]) < 0) traction += push.q.dot(across_[i]) * across_[i];
    const double area = geometry_->face_area[faces_[i]].norm();
    for (int a = 0; a < dim; ++a)
      forces[std::size_t(faces_[i] - mesh_->n_interior) * dim + a] += area * traction[a];
  }
}

}  // namespace couplet::solid
