// SPDX-License-Identifier: Apache-2.0
#include "coupler/judge/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "common/app/run_audit.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {

CouplingAudit::CouplingAudit(MPI_Comm comm, const std::vector<Side>& sides, const Links& links)
    : comm_(comm) {
  for (std::size_t i = 0; i < sides.size(); ++i) {
    std::vector<Force> forces;
    for (const coupling::Interface::Datum& datum : sides[i].interface.gives) {
      if (datum.unit != "N" || datum.place != coupling::Interface::Place::faces) continue;
      const bool taken = std::ranges::any_of(links.all(), [&](const Links::Link& link) {
        return link.giver == i && link.datum.name == datum.name;
      });
      forces.push_back({i, datum.name, taken});
    }
    // Where nothing is taken the coupling does not act by forces at all.
    if (std::ranges::any_of(forces, &Force::taken) && !std::ranges::all_of(forces, &Force::taken))
      forces_.insert(forces_.end(), forces.begin(), forces.end());
  }
}

bool CouplingAudit::looks_at(GlobalIndex step) {
  const auto n = static_cast<std::uint64_t>(step);
  return n >= 4 && std::has_single_bit(n) && std::countr_zero(n) % 2 == 0;
}

namespace {

// Participants solve to about 1e-8 of their values: less than that would be a ratio of their noise.
double ratio(const Residual& first, const Residual& second) {
  if (!(first.relative > 1e-6) || !std::isfinite(second.absolute)) return CouplingEvidence::unknown;
  return second.absolute / first.absolute;
}

}  // namespace

void CouplingAudit::returned(const Residual& first, const Residual& second) {
  evidence_.returned = std::fmax(evidence_.returned, ratio(first, second));
}

void CouplingAudit::returned_at_start(const Residual& first, const Residual& second) {
  at_start_ = ratio(first, second);
}

std::optional<std::string> CouplingAudit::suspects(const CouplingParameters& parameters) const {
  const double returned = std::fmax(at_start_, evidence_.returned), limit = limit_of_one_pass(parameters);
  if (!(returned > limit)) return {};
  return fmt::format(
      "the added-mass instability of explicit coupling: {:.3g} of a change of the motion returns through the load in the "
      "next pass, and one pass per step diverges from {:.2g}, whatever the step. Use `scheme: "
      "semi-implicit`, which iterates the added mass.",
      returned, limit);
}

void CouplingAudit::loads(const std::vector<coupling::Exchange>& given) {
  if (forces_.empty()) return;
  double size[2] = {0, 0};  // of the forces that nobody takes, and of those that somebody does
  for (const Force& force : forces_)
    if (const auto found = given[force.giver].find(force.name); found != given[force.giver].end())
      for (const double value : found->second) size[force.taken] += value * value;
  lost_ += parallel::sum(comm_, size[0]);
  taken_ += parallel::sum(comm_, size[1]);
  if (taken_ > 0) evidence_.lost_load = std::sqrt(lost_ / taken_);
}

void CouplingAudit::tell(const CouplingParameters& parameters, double time) {
  for (const effects::EffectVerdict& v :
       trail_.news(effects::audit(coupling_effect_cards(), parameters, evidence_)))
    app::report(parallel::comm_rank(comm_), time, v);
}

void CouplingAudit::tell_at_end(const CouplingParameters& parameters, bool with_sound) const {
  for (const effects::EffectVerdict& v : effects::audit(coupling_effect_cards(), parameters, evidence_))
    if (!(v.saves > 0) && (with_sound || !v.sound())) log::info("{}", effects::text(v));
}

std::vector<effects::Coordinate> CouplingAudit::position(const CouplingParameters& parameters) const {
  const double returned = std::isnan(evidence_.returned) ? at_start_ : evidence_.returned;
  if (std::isnan(returned)) return {};
  return {{"added mass over mass", returned, limit_of_one_pass(parameters), "coupling-mass"}};
}

coupling::ErrorParts CouplingAudit::parts(const CouplingParameters& parameters) const {
  effects::ModelError model =
      effects::model_error(effects::audit(coupling_effect_cards(), parameters, evidence_));
  coupling::ErrorParts parts;
  parts.model = model.sum;
  parts.model_by = std::move(model.largest);
  parts.omittable = std::move(model.omittable);
  return parts;
}

}  // namespace couplet::coupler
