// SPDX-License-Identifier: Apache-2.0
// What the participant has seen of the effects that it neglects.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/log/finding.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/parameters/effect_cards.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {
namespace {

/// Largest extent of the points [m]. Collective.
double size_of(const mesh::Mesh& mesh, std::span<const Vec3> centres) {
  constexpr double far = std::numeric_limits<double>::max();
  double square = 0;
  for (int c = 0; c < mesh.dim; ++c) {
    double low = far, high = -far;
    for (const Vec3& x : centres) low = std::min(low, x[c]), high = std::max(high, x[c]);
    square = std::max(square, std::pow(parallel::max(mesh.comm, high) - parallel::min(mesh.comm, low), 2));
  }
  return std::sqrt(square);
}

}  // namespace

/// Faces of walls that move across themselves.
template <int D>
std::vector<Index> FluidParticipant<D>::moving_faces() const {
  std::vector<Index> faces;
  for (const mesh::Patch& patch : mesh_.patches) {
    const GivenBy by = condition_of(fluid_->parameters().boundaries.at(patch.name)).velocity;
    if (by != GivenBy::structure && by != GivenBy::motion) continue;
    for (Index f = patch.first; f < patch.first + patch.count; ++f) faces.push_back(f);
  }
  return faces;
}

/// The walls' motion and the pressure's answer, where that may say something of the fluid's compliance. Collective.
template <int D>
void FluidParticipant<D>::see_motion() {
  const FluidParameters& p = fluid_->parameters();
  const bool moves = (interface_ && motion_) || !fluid_->boundary().body_patches().empty();
  const auto latest = moves ? fluid_->pressure() : nullptr;
  if (!latest || !sound_of(p.compressibility, p.density, p.viscosity)) return;
  const Placement<D>& now = *fluid_->state().placement;
  const std::vector<Index> faces = moving_faces();
  std::vector<double> swept;
  std::array<double, 4> sums{};  // swept, pressure times volume, pressure times area and area of inlets
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vec3 moved = now.boundary_centre[faces[i] - mesh_.n_interior] - at_start_[i];
    swept.push_back(moved.template head<D>().dot(now.area[faces[i]]));
    sums[0] += swept.back();
  }
  for (Index c = 0; c < mesh_.cells.n_owned(); ++c) sums[1] += latest->p[c] * now.volume[c];
  for (const mesh::Patch& patch : mesh_.patches)
    if (condition_of(p.boundaries.at(patch.name)).passage == Passage::in)
      for (Index f = patch.first; f < patch.first + patch.count; ++f) {
        sums[2] += latest->p[mesh_.owner[f]] * now.area[f].norm();
        sums[3] += now.area[f].norm();
      }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), int(sums.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  const double upstream = p.compressibility ? p.compressibility->upstream_volume : 0;
  if (sums[3] > 0) sums[1] += upstream * sums[2] / sums[3];
  compliance_.add(step_.dt, swept, {sums[0], sums[1]});
}

/// Of the trapezoidal rule.
template <int D>
void FluidParticipant<D>::see_ringing() {
  const auto& known = fluid_->parameters().compressibility;
  if (!known || known->scheme != WaveScheme::trapezoidal) return;
  const double share = RingingWatch::share(mesh_, fluid_->state());
  if (!ringing_.add(share)) return;
  log::finding(parallel::comm_rank(mesh_.comm),
               {.id = "ringing-pressure",
                .number = share,
                .limit = RingingWatch::limit,
                .sentence = fmt::format(
                    "t = {:.6g} s: the pressure rings: {:.2g} of it (limit {:g}) are waves of less than "
                    "four steps per period, which the trapezoidal rule does not damp",
                    step_.time + step_.dt, share, RingingWatch::limit),
                .advice = "use 'scheme: three-level' in 'compressibility', or a shorter step"});
}

template <int D>
void FluidParticipant<D>::add_motion(FluidEvidence& evidence) const {
  const ComplianceWatch::Walls mine = compliance_.walls();
  std::array<double, 3> walls{mine.square, mine.rate, mine.size};
  MPI_Allreduce(MPI_IN_PLACE, walls.data(), int(walls.size()), MPI_DOUBLE, MPI_SUM, mesh_.comm);
  if (!(walls[0] > 0)) return;
  const ComplianceWatch::Totals totals = compliance_.totals();
  // A plate in the fluid sweeps as much on one side as it leaves on the other.
  evidence.stroke = std::max(totals.swept, 0.5 * walls[2]);
  evidence.pressure_volume = totals.pressure_volume;
  evidence.wall_rate = std::sqrt(walls[1] / walls[0]);
  evidence.size = size_of(mesh_, fluid_->state().placement->boundary_centre);
}

template <int D>
std::vector<effects::EffectVerdict> FluidParticipant<D>::audit() const {
  FluidEvidence evidence{.largest_peclet = fluid_->sizes().largest_peclet(fluid_->state()),
                         .largest_yplus = 0};
  for (const mesh::Patch& patch : mesh_.patches)
    if (is_wall(fluid_->parameters().boundaries.at(patch.name)))
      evidence.largest_yplus = std::max(evidence.largest_yplus, summarise_wall(*fluid_, patch).largest_yplus);
  evidence.width = hydraulic_diameter(*fluid_);
  double speed = 0;
  for (const Vec<D>& u : fluid_->state().u) speed = std::max(speed, u.squaredNorm());
  evidence.largest_speed = std::sqrt(parallel::max(mesh_.comm, speed));
  // The pressure of the first step is the impulse that sets the fluid in motion.
  if (const auto latest = fluid_->pressure(); latest && step_.number > 0) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c)
      low = std::min(low, latest->p[c]), high = std::max(high, latest->p[c]);
    evidence.pressure_range = parallel::max(mesh_.comm, high) - parallel::min(mesh_.comm, low);
  }
  if (stands_still()) evidence.wall_displacement = displacement_;
  if (!fluid_->moving()) evidence.through_walls = through_moving_walls(*fluid_);
  if (fluid_->gaps()) {
    double blocked = 0;
    for (const auto& gap : fluid_->gaps()->facts()) blocked += gap.cells;
    evidence.blocked_cells = blocked / double(mesh_.cells.n_global());
  }
  add_motion(evidence);
  if (fluid_->parameters().turbulence) {
    double largest = 0;
    for (const double eddy : fluid_->state().eddy) largest = std::max(largest, eddy);
    evidence.eddy_viscosity =
        parallel::max(mesh_.comm, largest) * fluid_->parameters().density / fluid_->parameters().viscosity;
  }
  if (const EnergyLedger& ledger = fluid_->state().ledger; ledger.is_judged())
    evidence.energy_excess = ledger.excess / ledger.reference;
  const FluidScene scene{fluid_->parameters(), fluid_->moving(),
                         step_.scheme != coupling::Scheme::standalone};
  return couplet::effects::audit(fluid_effect_cards(), scene, evidence);
}

template <int D>
std::vector<std::string> FluidParticipant<D>::finish() {
  if (steps_unseen_ > 0) doubt_given_step(step_.dt / fluid_->statistics().sub_steps);
  for (std::string& doubt : openings_->doubts())
    log::finding(parallel::comm_rank(mesh_.comm),
                 {.id = "flow-through-openings", .sentence = std::move(doubt)});
  std::vector<std::string> sentences;
  if (statistics_ && !(statistics_->duration() > 0))
    sentences.push_back(
        fmt::format("Running statistics start at t = {:g} s, but this run ended before: there are none.",
                    fluid_->parameters().statistics->start));
  if (steps_ > 0)
    sentences.push_back(fmt::format(
        "Semi-implicit coupling: the friction was recomputed with an updated wall velocity in {} of {} "
        "steps; max error at the end of a step {:.2g} of the load{}",
        renewed_steps_, steps_, largest_unseen_,
        largest_unseen_ < near_limit || step_.scheme != coupling::Scheme::semi_implicit
            ? "."
            : ": the scheme is near its limit, where friction drags more than a third of the moving mass; "
              "use 'scheme: implicit' or a smaller step."));
  return sentences;
}

template std::vector<Index> FluidParticipant<2>::moving_faces() const;
template void FluidParticipant<2>::see_motion();
template void FluidParticipant<2>::see_ringing();
template void FluidParticipant<2>::add_motion(FluidEvidence&) const;
template std::vector<effects::EffectVerdict> FluidParticipant<2>::audit() const;
template std::vector<std::string> FluidParticipant<2>::finish();
template std::vector<Index> FluidParticipant<3>::moving_faces() const;
template void FluidParticipant<3>::see_motion();
template void FluidParticipant<3>::see_ringing();
template void FluidParticipant<3>::add_motion(FluidEvidence&) const;
template std::vector<effects::EffectVerdict> FluidParticipant<3>::audit() const;
template std::vector<std::string> FluidParticipant<3>::finish();

}  // namespace couplet::fluid
