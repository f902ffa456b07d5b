// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/boundary/seat.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/contact/contact.hpp"
#include "common/fv/expression.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::solid {

namespace {

/// A face is oriented towards the seat if its normal is within 60 degrees of the direction.
constexpr double least_cosine_to_seat = 0.5;
/// Stiffness of a rigid seat over that of the cells: each multiplier update reduces the penetration tenfold.
constexpr double rigid_scale = 10;

}  // namespace

Seat::Seat(const mesh::Mesh& mesh, const elastic::ElasticOperator& rows, const elastic::ElasticKernel& kernel,
           const contact::ContactParameters& p, std::span<const std::uint8_t> open, bool is_static)
    : mesh_(mesh),
      kernel_(kernel),
      direction_(Vec3::Zero()),
      is_conserving_(p.rule == contact::ContactRule::conserving),
      is_rigid_(is_static && !p.stiffness) {
  if (p.direction.empty()) direction_[mesh.dim - 1] = 1;
  for (std::size_t a = 0; a < p.direction.size(); ++a) direction_[Index(a)] = p.direction[a];
  const mesh::Geometry& geometry = rows.geometry();
  const fv::Expression height(p.height, "contact.height"), where(p.where, "contact.where");
  // The height is along a direction of any length, as for the plate; displacements are along the unit vector.
  const double length = direction_.norm();
  for (Index f = mesh.n_interior; f < mesh.n_flux_faces(); ++f) {
    if (!open[std::size_t(f - mesh.n_interior)]) continue;
    const Vec3 &x = geometry.face_centre[f], &area = geometry.face_area[f];
    const double towards = -area.dot(direction_) / length;
    if (towards < least_cosine_to_seat * area.norm() || !(where(x, 0) > 0)) continue;
    const elastic::LameConstants lame = rows.lame(mesh.owner[f]);
    const double depth = 2 * std::abs((x - geometry.cell_centre[mesh.owner[f]]).dot(area)) / area.norm();
    const double kappa =
        p.stiffness.value_or((is_rigid_ ? rigid_scale : 1) * p.scale * (2 * lame.mu + lame.lambda) / depth);
    faces_.push_back(
        {f, x, (x.dot(direction_) - height(x, 0)) / length - 0.5 * p.opening, kappa * towards, towards});
    numbers_.push_back(f);
  }
  direction_ /= length;
  if (parallel::sum(mesh.comm, GlobalIndex(faces_.size())) == 0)
    throw Error(
        "contact: no face of the solid points toward the seat. Check 'direction' (from the seat to the solid) and 'where'; "
        "only faces with a known force (free, interface, traction, pressure) can touch a seat.");
  if (!p.starts_inside) refuse_start_inside();
}

void Seat::refuse_start_inside() const {
  std::vector<double> here{0, 0, 0, 0};
  for (const Face& f : faces_)
    if (-f.gap > here[0] + 1e-12 * f.centre.norm()) here = {-f.gap, f.centre.x(), f.centre.y(), f.centre.z()};
  const std::vector<double> all = parallel::all_gather(mesh_.comm, here);
  std::size_t worst = 0;
  for (std::size_t i = 0; i < all.size(); i += 4)
    if (all[i] > all[worst]) worst = i;
  if (all[worst] > 0)
    throw Error(
        "contact.height: the solid starts {:.3g} m inside the seat, at ({:.4g}, {:.4g}, {:.4g}), which would push it off "
        "immediately. Move the seat or the mesh, or set 'starts-inside: true'.",
        all[worst], all[worst + 1], all[worst + 2], all[worst + 3]);
}

std::vector<double> Seat::along(std::span<const double> unknowns, std::span<const double> known) const {
  const std::size_t dim = std::size_t(mesh_.dim);
  std::vector<double> trace(faces_.size() * dim), result(faces_.size(), 0);
  kernel_.face_means(numbers_, unknowns, known, trace);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (std::size_t a = 0; a < dim; ++a) result[i] += trace[i * dim + a] * direction_[Index(a)];
  return result;
}

std::vector<double> Seat::penetration(std::span<const double> unknowns, std::span<const double> known) const {
  std::vector<double> result = along(unknowns, known);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = -faces_[i].gap - result[i];
  return result;
}

void Seat::add_to_faces(std::span<const double> forces, std::span<double> faces) const {
  const std::size_t dim = std::size_t(mesh_.dim);
  for (std::size_t i = 0; i < faces_.size(); ++i)
    for (std::size_t a = 0; a < dim; ++a)
      faces[std::size_t(faces_[i].face - mesh_.n_interior) * dim + a] += forces[i] * direction_[Index(a)];
}

void Seat::add_to_rows(std::span<const double> forces, std::span<double> rows) const {
  std::vector<double> faces(std::size_t(mesh_.boundary.n_owned()) * mesh_.dim, 0);
  add_to_faces(forces, faces);
  kernel_.add_face_forces(faces, rows);
}

Seat::Look Seat::look(std::span<const double> penetration, std::span<const double> forces) const {
  Look here;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const Face& f = faces_[i];
    const double delta = std::max(penetration[i], 0.), force = forces.empty() ? f.kappa * delta : forces[i];
    here.penetration = std::max(here.penetration, delta);
    here.force += force;
    here.pressure = std::max(here.pressure, force / f.area);
    if (force > 0) here.area += f.area;
    if (forces.empty()) here.energy += 0.5 * f.kappa * delta * delta;
  }
  for (double* sum : {&here.force, &here.energy, &here.area}) *sum = parallel::sum(mesh_.comm, *sum);
  for (double* most : {&here.penetration, &here.pressure}) *most = parallel::max(mesh_.comm, *most);
  return here;
}

void Pressing::look(std::span<const double> along) {
  for (std::size_t i = 0; i < force_.size(); ++i) {
    const double kappa = seat_.faces()[i].kappa, delta = base_[i] - factor_ * along[i];
    const contact::ContactForce push =
        before_.empty() ? contact::push(delta + multiplier_[i] / kappa) : contact::push(before_[i], delta);
    force_[i] = kappa * push.force;
    stiffness_[i] = kappa * push.slope * factor_;
  }
}

void Pressing::push_off(std::span<const double> unknowns, std::span<const double> known,
                        std::span<double> rows) {
  look(seat_.along(unknowns, known));
  seat_.add_to_rows(force_, rows);
}

double Pressing::take_multipliers(MPI_Comm comm) {
  double change = 0, largest = 0;
  for (std::size_t i = 0; i < force_.size(); ++i) {
    change = std::max(change, std::abs(force_[i] - multiplier_[i]));
    largest = std::max(largest, force_[i]);
  }
  multiplier_ = force_;
  change = parallel::max(comm, change);
  largest = parallel::max(comm, largest);
  return largest > 0 ? change / largest : change > 0 ? 1 : 0;
}

void Pressing::add_stiffness(std::span<const double> v, std::span<double> rows) const {
  std::vector<double> pull = seat_.along(v, {});
  for (std::size_t i = 0; i < pull.size(); ++i) pull[i] *= stiffness_[i];
  seat_.add_to_rows(pull, rows);
}

}  // namespace couplet::solid
