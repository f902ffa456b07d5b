// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {
namespace {

/// A restart with changes may have taken away the seat, or moved it, or the gravity: the energy that the structure has
/// in the new scene is where its balance starts from.
void take_changed_energy(const Oscillators& oscillators, bool tells, ModalState& state) {
  Energies& kept = state.energies;
  const Energies now = oscillators.start(state.q, state.v).energies;
  const double scale =
      std::abs(kept.kinetic) + std::abs(kept.strain) + std::abs(kept.gravity) + std::abs(kept.contact);
  const double jump = now.contact - kept.contact + now.gravity - kept.gravity;
  if (!(std::abs(now.contact - kept.contact) + std::abs(now.gravity - kept.gravity) > 1e-9 * scale)) return;
  if (tells)
    log::warn(
        "energy: with the changes of this restart the seat stores {:.4g} J instead of {:.4g} J, and gravity "
        "{:.4g} J instead of {:.4g} J: this jump of {:.4g} J is not part of the balance.",
        now.contact, kept.contact, now.gravity, kept.gravity, jump);
  kept.contact = now.contact;
  kept.gravity = now.gravity;
  kept.initial += jump;
}

}  // namespace

void Structure::save(io::CheckpointWriter& file) const {
  file.write_common("omega", share_->omega());
  for (const auto& [name, values] : {std::pair{"q", &state_.q},
                                     {"v", &state_.v},
                                     {"a", &state_.a},
                                     {"q-old", &state_.q_old},
                                     {"v-old", &state_.v_old},
                                     {"partner", &state_.partner}})
    file.write_common(name, *values);
  const Energies& e = state_.energies;
  file.write_common("energies", std::vector<double>{e.kinetic, e.strain, e.gravity, e.contact, e.initial,
                                                    e.load_work, e.impact_work, e.damping_loss,
                                                    worst_mismatch_, largest_exchange_, largest_true_});
  file.write_common("largest", std::vector<double>{largest_, largest_rotation_, within_[0], within_[1],
                                                   on_modes_.part, on_modes_.most, load_acted_ ? 1. : 0.});
  file.write_common("truncation", truncation_ ? truncation_->state() : std::vector<double>(2, 0));
  file.write_scalar("dt", state_.dt);
  if (resolution_) file.write_common("resolution", resolution_->state());
  file.write_common("errors", step_errors_ ? step_errors_->state() : std::vector<double>{});
}

void Structure::load(io::CheckpointReader& file) {
  if (file.read_common("omega") != share_->omega())
    throw Error(
        "The checkpoint was written with other modes than this run uses: mesh, material, thickness, "
        "supports or the number of modes differ.");
  state_ = initial_state();
  for (const auto& [name, values] : {std::pair{"q", &state_.q},
                                     {"v", &state_.v},
                                     {"a", &state_.a},
                                     {"q-old", &state_.q_old},
                                     {"v-old", &state_.v_old}})
    file.read_common(name, *values);
  state_.partner = file.read_common("partner");
  std::vector<double> kept(11);
  file.read_common("energies", kept);
  Energies& e = state_.energies;
  int i = 0;
  for (double* part : {&e.kinetic, &e.strain, &e.gravity, &e.contact, &e.initial, &e.load_work,
                       &e.impact_work, &e.damping_loss, &worst_mismatch_, &largest_exchange_, &largest_true_})
    *part = kept[i++];
  take_changed_energy(*oscillators_, parallel::comm_rank(context_.comm) == 0, state_);
  std::vector<double> largest(7), left_out(2);
  file.read_common("largest", largest);
  largest_ = largest[0], largest_rotation_ = largest[1];
  within_ = {largest[2], largest[3]};
  on_modes_ = {largest[4], largest[5]};
  load_acted_ = largest[6] != 0;
  file.read_common("truncation", left_out);
  if (truncation_) truncation_->restore(left_out);
  state_.dt = file.read_scalar("dt");
  if (resolution_) {
    std::vector<double> seen = resolution_->state();
    file.read_common("resolution", seen);
    resolution_->restore(seen);
  }
  const std::vector<double> errors = file.read_common("errors");
  if (step_errors_) step_errors_->restore(errors);
  trial_ = state_;
}

}  // namespace couplet::plate
