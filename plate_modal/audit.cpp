// SPDX-License-Identifier: Apache-2.0
// What a run says of itself: evidence for the cards.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/mesh/on_root.hpp"
#include "common/modes/rigid_motion.hpp"
#include "plate_modal/effect_cards.hpp"
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

}  // namespace

/// Rigid motions may go as far as they like, but a mode turns the body by its tangent only.
void Structure::find_rotations() {
  const std::vector<double>& omega = share_->omega();
  if (std::ranges::none_of(omega, [](double w) { return w == 0; })) return;
  std::vector<double> flat(3 * omega.size(), 0);
  if (comm_rank(context_.comm) == 0)
    for (std::size_t m = 0; m < omega.size(); ++m)
      if (omega[m] == 0) {
        const Vec3 turn = rigid_motion(built_.model, m).rotation;
        for (int c = 0; c < 3; ++c) flat[3 * m + c] = turn[c];
      }
  broadcast(context_.comm, flat);
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

std::vector<EffectVerdict> Structure::audit() const {
  // What rank 0 knows of the whole surface decides on all ranks alike.
  std::vector<double> seen(3, PlateEvidence::unknown);
  if (comm_rank(context_.comm) == 0) {
    double size = 0;
    for (const Vec3& x : built_.model.vertices)
      size = std::max(size, (x - built_.model.vertices.front()).norm());
    // A body that moves as a whole may go far, but not turn far.
    if (share_->omega().front() > 0) seen[0] = largest_ / size;
    if (built_.held_all_round) seen[1] = largest_ / parameters_.thickness;
    if (deflection_ && deflection_->direct > 0) seen[2] = deflection_->apart / deflection_->direct;
  }
  broadcast(context_.comm, seen);
  PlateEvidence evidence;
  evidence.displacement_over_size = seen[0];
  evidence.displacement_over_thickness = seen[1];
  evidence.modes_apart = seen[2];
  if (!rotations_.empty()) evidence.rotation = largest_rotation_;
  if (!parameters_.modes_file && parameters_.analysis == Parameters::Analysis::dynamic)
    evidence.in_plane_share = in_plane_share();
  if (resolution_) evidence.step = resolution_->evidence(step_.is_last);
  // Where nothing has moved yet, or nothing will, the modes themselves are the answer.
  if (parameters_.mesh && !(resolution_ && std::isnan(evidence.step.last_mode_omega)))
    evidence.thickness_over_wave = thickness_over_wave(
        parameters_, resolution_ ? evidence.step.last_mode_omega : share_->omega().back());
  if (parameters_.analysis == Parameters::Analysis::dynamic && largest_exchange_ > 0)
    evidence.energy_mismatch = worst_mismatch_ / largest_exchange_;
  return couplet::audit(plate_effect_cards(), PlateScene{parameters_}, evidence);
}

}  // namespace couplet::plate
