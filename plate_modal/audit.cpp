// SPDX-License-Identifier: Apache-2.0
// What a run says of itself: evidence for the cards.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/mesh/on_root.hpp"
#include "common/modes/rigid_motion.hpp"
#include "plate_modal/effect_cards.hpp"
#include "plate_modal/model/outline.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {
namespace {

/// Thickness over half the length of a bending wave of this frequency in the thickest part of a plate:
/// D k^4 = rho h omega^2.
double thickness_over_wave(const Parameters& p, double omega) {
  double largest = 0;
  const auto of = [&](double h, double density, double youngs_modulus) {
    const double d =
        youngs_modulus * h * h * h / (12 * (1 - p.material.poissons_ratio * p.material.poissons_ratio));
    largest = std::max(largest, h * std::pow(density * h * omega * omega / d, 0.25) / std::numbers::pi);
  };
  of(p.thickness, p.material.density, p.material.youngs_modulus);
  for (const auto& [name, zone] : p.zones)
    of(zone.thickness.value_or(p.thickness), zone.density.value_or(p.material.density),
       zone.youngs_modulus.value_or(p.material.youngs_modulus));
  return largest;
}

/// Share of the energy of the initial velocity that no mode has.
double velocity_lost(const Share& share, const Vec3& v) {
  if (!(v.norm() > 0)) return PlateEvidence::unknown;
  double kept = 0;
  for (const double one : share.participation(v)) kept += one * one;
  return std::max(0.0, 1 - kept / (share.mass() * v.squaredNorm()));
}

}  // namespace

/// Rigid motions may go as far as they like, but a mode turns the body by its tangent only.
void Structure::find_rotations() {
  const std::vector<double>& omega = share_->omega();
  if (std::ranges::none_of(omega, [](double w) { return w == 0; })) return;
  std::vector<double> flat(3 * omega.size(), 0);
  if (parallel::comm_rank(context_.comm) == 0)
    for (std::size_t m = 0; m < omega.size(); ++m)
      if (omega[m] == 0) {
        const Vec3 turn = modes::rigid_motion(built_.model, m).rotation;
        for (int c = 0; c < 3; ++c) flat[3 * m + c] = turn[c];
      }
  mesh::broadcast(context_.comm, flat);
  for (std::size_t m = 0; m < omega.size(); ++m) rotations_.emplace_back(&flat[3 * m]);
}

void Structure::look_at_rotation() {
  Vec3 turn = Vec3::Zero();
  for (std::size_t m = 0; m < rotations_.size(); ++m) turn += state_.q[m] * rotations_[m];
  largest_rotation_ = std::max(largest_rotation_, turn.norm());
}

/// The largest share in the plane of what pushes or moves the whole plate: modes of bending do not answer it.
double Structure::in_plane_share() const {
  const Vec3 normal = parameters_.placement.normal();
  const auto share = [&](const Vec3& all) {
    return all.norm() > 0 ? (all - all.dot(normal) * normal).norm() / all.norm() : 0;
  };
  double largest = share(parameters_.initial_velocity);
  // Supports hold the weight along a plate; nothing holds a plate that may fall as a whole.
  if (!parameters_.gravity.empty() && !rotations_.empty())
    largest = std::max(largest, share(Vec3(parameters_.gravity.data())));
  return largest;
}

/// The forces of a fluid along the normal, as pressures on the cells: what the modes left out would see of them.
void Structure::take_fluid(const coupling::Exchange& in) {
  fluid_pressure_.clear();
  const auto given = in.find("pressure-force");
  if (given == in.end() || given->second.empty()) return;
  const Vec3 normal = parameters_.placement.normal();
  const std::vector<double> areas = built_.plate->cell_areas();
  const std::size_t sides = parameters_.wetted == Wetted::both ? 2 : 1;
  fluid_pressure_.assign(areas.size(), 0);
  for (std::size_t f = 0; f < sides * areas.size(); ++f)
    fluid_pressure_[f % areas.size()] += Vec3(&given->second[3 * f]).dot(normal) / areas[f % areas.size()];
}

/// At the times at which a run is judged in its first steps, and ever more rarely.
void Structure::look_at_modes() {
  const long steps = resolution_->steps();
  const bool power_of_two = (steps & (steps - 1)) == 0;
  if (!(steps <= 8 || power_of_two || step_.is_last)) return;
  const double t = step_.time + 0.5 * step_.dt;
  mesh::on_root(context_.comm, [&] {
    look_at_pressure(t);
    if (!truncation_) return;
    std::vector<double> pressure;
    try {
      pressure = cell_pressures(t);
    } catch (const Error&) {
      return;  // no value there: the scheme need not ask for it
    }
    for (std::size_t c = 0; c < fluid_pressure_.size(); ++c) pressure[c] += fluid_pressure_[c];
    truncation_->look(pressure);
  });
}

void Structure::look_at_pressure(double t) {
  if (!pressure_) return;
  const LoadOnModes now = load_on_modes(built_.model, *pressure_, t);
  on_modes_.part += now.part;
  on_modes_.most += now.most;
  const WithinFaces seen = within_faces(built_.model, *pressure_, t);
  within_[0] += seen.apart;
  within_[1] += seen.size;
}

/// Of the modes by their share of the motion; of a modal analysis: of the highest mode. On rank 0.
double Structure::mesh_gap() const {
  const Vec3 normal = parameters_.placement.normal();
  const std::size_t sides = parameters_.wetted == Wetted::both ? 2 : 1;
  std::size_t cells = 0;
  for (const double density : built_.model.face_density) cells += density > 0;
  const std::vector<double> gaps = mesh_gaps(built_.model, cells / sides, normal);
  if (parameters_.analysis == Parameters::Analysis::modal) return with_corners(gaps.back(), built_.kinks);
  double all = 0, apart = 0;
  for (std::size_t m = 0; m < gaps.size(); ++m) {
    const double moved = resolution_ ? resolution_->moved()[m] : state_.q[m] * state_.q[m];
    all += moved;
    apart += moved * gaps[m] * gaps[m];
  }
  return all > 0 ? with_corners(std::sqrt(apart / all), built_.kinks) : PlateEvidence::unknown;
}

std::vector<effects::EffectVerdict> Structure::audit() const {
  // What rank 0 knows of the whole surface decides on all ranks alike.
  std::vector<double> seen(8, PlateEvidence::unknown);
  if (parallel::comm_rank(context_.comm) == 0) {
    double size = 0;
    for (const Vec3& x : built_.model.vertices)
      size = std::max(size, (x - built_.model.vertices.front()).norm());
    // A body that moves as a whole may go far, but not turn far.
    if (share_->omega().front() > 0) seen[0] = largest_ / size;
    if (built_.stretch_limit > 0) seen[1] = largest_ / parameters_.thickness;
    seen[6] = built_.stretch_limit;
    if (deflection_ && deflection_->direct > 0) seen[2] = deflection_->apart / deflection_->direct;
    if (within_[1] > 0) seen[3] = std::sqrt(within_[0] / within_[1]);
    if (!parameters_.modes_file) seen[4] = mesh_gap();
    if (truncation_) seen[5] = truncation_->share();
    if (on_modes_.most > 0) seen[7] = std::sqrt(on_modes_.part / on_modes_.most);
  }
  mesh::broadcast(context_.comm, seen);
  PlateEvidence evidence;
  evidence.displacement_over_size = seen[0];
  evidence.displacement_over_thickness = seen[1];
  evidence.stretch_limit = seen[6];
  // A load that does nothing yet may come: it is judged at the end.
  if (pressure_ && finished_ && parameters_.analysis != Parameters::Analysis::modal) {
    evidence.load_lost = !load_acted_ && (pressure_->changes_in_time() || !pressure_->is_uniform());
    evidence.load_on_modes = seen[7];
  }
  evidence.modes_apart = resolution_ ? seen[5] : seen[2];
  evidence.within_faces = seen[3];
  evidence.mesh_gap = seen[4];
  if (resolution_) evidence.velocity_lost = velocity_lost(*share_, parameters_.initial_velocity);
  if (!rotations_.empty()) evidence.rotation = largest_rotation_;
  if (!parameters_.modes_file && parameters_.analysis == Parameters::Analysis::dynamic)
    evidence.in_plane_share = in_plane_share();
  if (resolution_) evidence.step = resolution_->evidence(step_.is_last);
  // What has no part at all in the load is not moved by it at any frequency.
  if (seen[5] < 1e-6) evidence.step.load_over_last = StepEvidence::unknown;
  // Where nothing has moved yet, or nothing will, the modes themselves are the answer.
  if (parameters_.mesh && !(resolution_ && std::isnan(evidence.step.last_mode_omega)))
    evidence.thickness_over_wave = thickness_over_wave(
        parameters_, resolution_ ? evidence.step.last_mode_omega : share_->omega().back());
  if (parameters_.analysis == Parameters::Analysis::dynamic && largest_exchange_ > 0)
    evidence.energy_mismatch = worst_mismatch_ / largest_exchange_;
  return couplet::effects::audit(plate_effect_cards(), PlateScene{parameters_}, evidence);
}

/// Where the modes come from a file nothing is known of their mesh. A load that cells do not resolve is an error of them.
coupling::ErrorParts Structure::error_parts() const {
  coupling::ErrorParts parts;
  if (step_errors_ && resolution_) parts.step = step_errors_->over_size();
  std::vector<double> gap(1, PlateEvidence::unknown);
  if (!parameters_.modes_file && parallel::comm_rank(context_.comm) == 0) {
    gap[0] = mesh_gap();
    if (within_[1] > 0) gap[0] += std::sqrt(within_[0] / within_[1]);
  }
  mesh::broadcast(context_.comm, gap);
  parts.mesh = gap[0];
  return parts;
}

}  // namespace couplet::plate
