// SPDX-License-Identifier: Apache-2.0

#include "solid_solver/boundary/loads.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/elasticity/vector_at.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

/// Smallest over largest squared extent of faces that carry a moment about any axis.
constexpr double flat = 1e-10;
/// Relative tolerance for a moment about a line of faces.
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
    // In 2-D all centers are at z = 0 and moments are about z.
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

/// A moment about a line of faces cannot be applied.
void DistributedForce::check_taken(const Vec3& moment, const Vec3& force) const {
  const double scale = force.norm() * (arm_.norm() + std::sqrt(inertia_.trace() / area_)) + moment.norm();
  if ((lost_ * moment).norm() <= rounding * scale) return;
  const Vec3 axis = (lost_ * moment).normalized();
  throw Error(
      "{}: the face centers lie on one line through ({:g}, {:g}, {:g}), so they cannot transmit a moment about ({:.3g}, "
      "{:.3g}, {:.3g}), but the load has {:g} N m. Refine the patch, select more faces or use 'type: force'.",
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

namespace {

// Limits for the mean squared normals: along the axis (facets of a coarse cylinder), and across it (a 40
// degree strip of a cylinder).
constexpr double along_axis = 0.02, curved = 0.04;
// Share of a force that may be along an axis found from such facets.
constexpr double most_axial = 0.05;
// Maximum number of iterations for the loaded half; usually one.
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

/// q as in the class. Iterates until the half chosen by the force is the one with positive pressure.
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

HydrostaticPressure::HydrostaticPressure(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                         const TotalLoad& load, const std::string& where)
    : mesh_(&mesh), geometry_(&geometry), level_(load.level, where + ".level"), use_(&fv::uses()[where]) {
  use_->given = "the hydrostatic pressure";
  Vec3 gravity = Vec3::Zero();
  for (std::size_t a = 0; a < load.gravity.size(); ++a) gravity[Index(a)] = load.gravity[a];
  up_ = -gravity.normalized();
  weight_ = load.density * gravity.norm();
}

double mean_positive(double d0, double d1) {
  if (d0 > d1) std::swap(d0, d1);
  if (d1 <= 0) return 0;
  return d0 >= 0 ? 0.5 * (d0 + d1) : 0.5 * d1 * d1 / (d1 - d0);
}

double mean_positive(double d0, double d1, double d2) {
  double d[3]{d0, d1, d2};
  std::sort(d, d + 3);
  if (d[2] <= 0) return 0;
  const double all = (d[0] + d[1] + d[2]) / 3;
  if (d[0] >= 0) return all;
  // Below the corner alone on its side of the surface: a similar triangle with a third of its depth as mean.
  const auto corner = [](double alone, double a, double b) {
    return alone * alone * alone / (3 * (alone - a) * (alone - b));
  };
  return d[1] <= 0 ? corner(d[2], d[0], d[1]) : all + corner(-d[0], -d[1], -d[2]);
}

double HydrostaticPressure::at(const Vec3& x, double level) const {
  const double pressure = weight_ * std::max(0., level - up_.dot(x));
  use_->note(pressure);
  return pressure;
}

double HydrostaticPressure::mean(Index face, double level, const Vec3& shift) const {
  const double pressure = below(face, level, shift);
  use_->note(pressure);
  return pressure;
}

double HydrostaticPressure::below(Index face, double level, const Vec3& shift) const {
  const auto points = mesh_->face_points[face];
  const auto place = [&](std::size_t i) -> const Vec3& { return geometry_->points[points[i]]; };
  const auto depth = [&](const Vec3& x) { return level - up_.dot(x + shift); };
  if (mesh_->dim == 2) return weight_ * mean_positive(depth(place(0)), depth(place(1)));
  if (points.size() == 3) return weight_ * mean_positive(depth(place(0)), depth(place(1)), depth(place(2)));
  // Cut by a diagonal. Areas along the mean normal, as those of the face are.
  const Vec3 n = geometry_->face_area[face].normalized();
  const auto area = [&](std::size_t b, std::size_t c) {
    return n.dot((place(b) - place(0)).cross(place(c) - place(0)));
  };
  const double first = area(1, 2), second = area(2, 3);
  return weight_ *
         (first * mean_positive(depth(place(0)), depth(place(1)), depth(place(2))) +
          second * mean_positive(depth(place(0)), depth(place(2)), depth(place(3)))) /
         (first + second);
}

namespace {

/// A point farther from the nearest face than this many face widths is not on the body.
constexpr double widths = 2;

/// Nearest boundary face of all ranks; ties go to the first in the file.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  GlobalIndex id = std::numeric_limits<GlobalIndex>::max();
  double width = 0;
  Index face = -1;  // on the rank that has it
  int is_open = 0, patch = -1;
};

Nearest nearest_face(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const Vec3& point,
                     std::span<const std::uint8_t> open) {
  Nearest mine;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    const mesh::Patch& patch = mesh.patches[p];
    if (patch.bonded) continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) {
      const double distance = (geometry.face_centre[f] - point).norm();
      const GlobalIndex id = mesh.boundary_id[f - mesh.n_interior];
      if (distance > mine.distance || (distance == mine.distance && id > mine.id)) continue;
      const double area = geometry.face_area[f].norm();
      mine = {distance,
              id,
              mesh.dim == 3 ? std::sqrt(area) : area,
              f,
              open[std::size_t(f - mesh.n_interior)],
              static_cast<int>(p)};
    }
  }
  Nearest best;
  for (const Nearest& other : parallel::all_gather(mesh.comm, std::vector<Nearest>{mine}))
    if (std::pair(other.distance, other.id) < std::pair(best.distance, best.id)) best = other;
  if (best.id != mine.id) best.face = -1;
  return best;
}

}  // namespace

std::string place_of(const Vec3& x, int dim) {
  return dim == 3 ? fmt::format("({:g}, {:g}, {:g})", x[0], x[1], x[2])
                  : fmt::format("({:g}, {:g})", x[0], x[1]);
}

std::vector<Index> faces_of_point_load(const mesh::Mesh& mesh, const mesh::Geometry& geometry,
                                       const PointLoad& load, std::span<const std::uint8_t> open,
                                       const std::string& where) {
  std::vector<Index> faces;
  const Nearest nearest = nearest_face(mesh, geometry, load.point, open);
  if (load.radius == 0) {
    if (nearest.distance > widths * nearest.width)
      throw Error(
          "{}.point: {} m is off the surface: the nearest face is {:g} m away and {:.2g} m wide. Check the "
          "unit, or give a 'radius'.",
          where, place_of(load.point, mesh.dim), nearest.distance, nearest.width);
    if (nearest.is_open == 0)
      throw Error(
          "{}.point: the face nearest to {} m belongs to patch '{}' and is supported there, so a force on it has no effect. "
          "Move the point, or give a 'radius' that reaches unsupported faces.",
          where, place_of(load.point, mesh.dim), mesh.patches[std::size_t(nearest.patch)].name);
    if (nearest.face >= 0) faces.push_back(nearest.face);
    return faces;
  }
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f)
    if (open[std::size_t(f - mesh.n_interior)] &&
        (geometry.face_centre[f] - load.point).norm() <= load.radius)
      faces.push_back(f);
  if (!parallel::any(mesh.comm, !faces.empty()))
    throw Error(
        "{}.radius: no unsupported face has its center within {:g} m of {} m; the nearest face is {:g} m "
        "away{}.",
        where, load.radius, place_of(load.point, mesh.dim), nearest.distance,
        nearest.is_open ? "" : " and is supported");
  return faces;
}

namespace {

// Smallest over largest moment of inertia of faces that are not collinear.
constexpr double on_a_line = 1e-10;
constexpr std::size_t motions = 6;

}  // namespace

RigidPatches::RigidPatches(const mesh::Mesh& mesh, const elastic::ElasticOperator& elastic,
                           const std::vector<std::vector<Index>>& faces)
    : mesh_(&mesh) {
  const mesh::Geometry& geometry = elastic.geometry();
  const std::vector<Index>& unknown = elastic.unknown_faces();
  for (const std::vector<Index>& of_patch : faces) {
    Patch patch;
    for (const Index f : of_patch) {
      const auto found = std::ranges::lower_bound(unknown, f);
      patch.node.push_back(std::size_t(mesh.cells.n_owned()) + std::size_t(found - unknown.begin()));
      patch.arm.push_back(geometry.face_centre[f]);
    }
    make(patch);
    patches_.push_back(std::move(patch));
  }
}

void RigidPatches::make(Patch& patch) const {
  const MPI_Comm comm = mesh_->comm;
  patch.share = 1 / parallel::sum(comm, double(patch.node.size()));
  Vec3 total = Vec3::Zero();
  for (const Vec3& x : patch.arm) total += x;
  const Vec3 centre = sum_of(comm, total) * patch.share;
  Tensor3 inertia = Tensor3::Zero();
  for (Vec3& r : patch.arm) {
    r -= centre;
    inertia += r.squaredNorm() * Tensor3::Identity() - r * r.transpose();
  }
  inertia = sum_of(comm, inertia);
  if (mesh_->dim == 2) {  // about z alone
    if (inertia(2, 2) > 0) patch.spin(2, 2) = 1 / inertia(2, 2);
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Tensor3> axes(inertia);
  for (int k = 0; k < 3; ++k)
    if (axes.eigenvalues()[k] > on_a_line * axes.eigenvalues()[2])
      patch.spin +=
          axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose() / axes.eigenvalues()[k];
}

void RigidPatches::project(std::span<double> unknowns) const {
  if (patches_.empty()) return;
  const int dim = mesh_->dim;
  std::vector<double> sums(motions * patches_.size(), 0);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    Vec3 total = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t i = 0; i < patches_[p].node.size(); ++i) {
      const Vec3 v = elastic::vector_at(unknowns, Index(patches_[p].node[i]), dim);
      total += v;
      moment += patches_[p].arm[i].cross(v);
    }
    std::copy_n(total.data(), 3, &sums[motions * p]);
    std::copy_n(moment.data(), 3, &sums[motions * p + 3]);
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_->comm);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Patch& patch = patches_[p];
    const Vec3 shift = patch.share * Vec3(sums[motions * p], sums[motions * p + 1], sums[motions * p + 2]);
    const Vec3 turn = patch.spin * Vec3(sums[motions * p + 3], sums[motions * p + 4], sums[motions * p + 5]);
    for (std::size_t i = 0; i < patch.node.size(); ++i) {
      const Vec3 v = shift + turn.cross(patch.arm[i]);
      for (int a = 0; a < dim; ++a) unknowns[patch.node[i] * std::size_t(dim) + std::size_t(a)] = v[a];
    }
  }
}

}  // namespace couplet::solid
