// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/distributed_force.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {
namespace {

/// Least over largest extent squared of faces that take a moment about every axis.
constexpr double flat = 1e-10;
/// Of a moment about a line of faces, over what the load has.
constexpr double rounding = 1e-9;

std::vector<fv::Expression> expressions(const std::vector<config::ExpressionText>& texts, int n,
                                        const std::string& where) {
  return texts.empty() ? std::vector<fv::Expression>() : fv::make_expressions(texts, n, where);
}

}  // namespace

Vec3 sum_of(MPI_Comm comm, const Vec3& value) {
  Vec3 total;
  for (int a = 0; a < 3; ++a) total[a] = parallel::sum(comm, value[a]);
  return total;
}

Tensor3 sum_of(MPI_Comm comm, const Tensor3& value) {
  Tensor3 total;
  for (int a = 0; a < 3; ++a) total.col(a) = sum_of(comm, Vec3(value.col(a)));
  return total;
}

DistributedForce::DistributedForce(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                   std::vector<Index> faces, const TotalLoad& load, bool has_point,
                                   const std::string& where)
    : mesh_(&mesh),
      geometry_(&geometry),
      where_(where),
      faces_(std::move(faces)),
      force_(expressions(load.force, mesh.dim, where)),
      moment_(expressions(load.moment, mesh.dim == 3 ? 3 : 1, where)) {
  Vec3 first = Vec3::Zero();
  double area = 0;
  for (const Index f : faces_) {
    const double size = geometry.face_area[f].norm();
    area += size;
    first += size * geometry.face_centre[f];
  }
  area_ = parallel::sum(mesh.comm, area);
  if (!(area_ > 0)) throw Error("{}: the faces with this load have zero area.", where);
  centre_ = sum_of(mesh.comm, first) / area_;
  if (!has_point) return;
  Tensor3 inertia = Tensor3::Zero();
  for (const Index f : faces_) {
    const Vec3 r = geometry.face_centre[f] - centre_;
    inertia += geometry.face_area[f].norm() * (r.squaredNorm() * Tensor3::Identity() - r * r.transpose());
  }
  inertia_ = sum_of(mesh.comm, inertia);
  arm_ = load.point - centre_;
  if (mesh.dim == 2) arm_[2] = 0;
  find_spin();
}

void DistributedForce::find_spin() {
  const int dim = mesh_->dim;
  const Eigen::SelfAdjointEigenSolver<Tensor3> axes(inertia_);
  for (int k = 0; k < 3; ++k) {
    // In two dimensions all centres lie at z = 0, and moments are those about z.
    const Vec3 e = dim == 2 ? Vec3(Vec3::Unit(k)) : Vec3(axes.eigenvectors().col(k));
    const double inertia = e.dot(inertia_ * e);
    const double least = dim == 2 ? flat * area_ * area_ * area_ : flat * axes.eigenvalues()[2];
    if (dim == 2 && k != 2) continue;
    if (inertia > least)
      spin_ += e * e.transpose() / inertia;
    else
      lost_ += e * e.transpose();
  }
}

Vec3 DistributedForce::force(double t) const {
  Vec3 total = Vec3::Zero();
  for (std::size_t a = 0; a < force_.size(); ++a) total[Index(a)] = force_[a](Vec3::Zero(), t);
  return total;
}

Vec3 DistributedForce::moment_about_centre(double t) const {
  Vec3 moment = arm_.cross(force(t));
  if (moment_.size() == 1)
    moment[2] += moment_[0](Vec3::Zero(), t);
  else
    for (std::size_t a = 0; a < moment_.size(); ++a) moment[Index(a)] += moment_[a](Vec3::Zero(), t);
  return moment;
}

/// A moment about an axis on which all faces lie would go lost.
void DistributedForce::check_taken(const Vec3& moment, const Vec3& force) const {
  const double scale = force.norm() * (arm_.norm() + std::sqrt(inertia_.trace() / area_)) + moment.norm();
  if ((lost_ * moment).norm() <= rounding * scale) return;
  const Vec3 axis = (lost_ * moment).normalized();
  throw Error(
      "{}: the face centres lie on one line through ({:g}, {:g}, {:g}), so they cannot transmit a moment "
      "about ({:.3g}, {:.3g}, {:.3g}), but the load has {:g} N m. Refine the patch, select more faces or "
      "use 'type: force'.",
      where_, centre_[0], centre_[1], centre_[2], axis[0], axis[1], axis[2], (lost_ * moment).norm());
}

void DistributedForce::add_forces(double t, std::span<double> forces) const {
  const int dim = mesh_->dim;
  const Vec3 total = force(t), moment = moment_about_centre(t), traction = total / area_,
             turn = spin_ * moment;
  check_taken(moment, total);
  for (const Index f : faces_) {
    const Vec3 r = geometry_->face_centre[f] - centre_;
    const Vec3 push = geometry_->face_area[f].norm() * (traction + turn.cross(r));
    for (int a = 0; a < dim; ++a) forces[std::size_t(f - mesh_->n_interior) * dim + a] += push[a];
  }
}

}  // namespace couplet::solid
