// SPDX-License-Identifier: Apache-2.0
// What the coupler keeps over a restart.
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "coupler/exchange/foreign_structure.hpp"

namespace couplet::coupler {
namespace {

void write(io::CheckpointWriter& file, const std::string& name, const Iterate& x, const IterateOrder& order) {
  file.write(order.unknown, name, x.unknown);
  file.write(order.rider, name + "-rider", x.rider);
}

/// As much as the coupling has unknowns and values that ride along, or nothing.
Iterate read(io::CheckpointReader& file, const std::string& name, const IterateOrder& order) {
  return {file.read_or_none(order.unknown, name, 1), file.read_or_none(order.rider, name + "-rider", 1)};
}

}  // namespace

/// Displacements of the wall of a participant that Mechanics watches.
parallel::GlobalOrder Coupler::order_of_wall(std::size_t i) const {
  return sides_[mechanics_->side_of_wall(i)].order(comm_, coupling::Interface::Place::vertices);
}

void Coupler::save(const std::filesystem::path& folder) {
  enter_(app::Phase::save, {});
  ask_all(everyone(), {coupling::Op::save, {}, {}, 0, -1, folder.string()});
  io::CheckpointWriter file(comm_, folder / "coupler.h5");
  const IterateOrder order = unknown_->order(false);
  write(file, "now", history_.now, order);
  write(file, "old", history_.old, order);
  write(file, "older", history_.older, order);
  file.write_scalar("old-dt", history_.old_dt);
  file.write_scalar("older-dt", history_.older_dt);
  file.write_common("weights", unknown_->weights());
  for (std::size_t i = 0; i < mechanics_->walls().size(); ++i)
    file.write(order_of_wall(i), "wall-" + std::to_string(i), mechanics_->walls()[i]);
  file.write_common("work", work_guard_.totals());
  file.write_common("scheme", scheme_.state());
  if (accelerator_) accelerator_->save(file, unknown_->order(true));
  if (volume_level_) volume_level_->save(file, sides_);
  for (const Partner& partner : partners_)
    if (const auto* foreign = dynamic_cast<const ForeignStructure*>(partner.channel.get()))
      foreign->save(file);
  file.write_common("errors", errors_ ? errors_->state() : std::vector<double>{});
  file.write_common("lag", lag_ ? lag_->state() : std::vector<double>{});
  if (lag_)
    for (std::size_t k = 0; const auto* field : lag_->fields())
      file.write(order.rider, "lag-" + std::to_string(k++), *field);
  file.close();
}

void Coupler::load() {
  enter_(app::Phase::load, {});
  io::CheckpointReader file(comm_, folders_.restart / "coupler.h5");
  const IterateOrder order = unknown_->order(false);
  history_.now = read(file, "now", order);
  history_.old = read(file, "old", order);
  history_.older = read(file, "older", order);
  history_.old_dt = file.read_scalar("old-dt");
  history_.older_dt = file.read_scalar("older-dt");
  unknown_->restore_weights(file.read_common("weights"));
  for (std::size_t i = 0; i < mechanics_->walls().size(); ++i)
    file.read(order_of_wall(i), "wall-" + std::to_string(i), mechanics_->walls()[i]);
  std::array<double, 6> work{};
  file.read_common("work", work);
  work_guard_.restore(work);
  std::array<double, 2> scheme{};
  file.read_common("scheme", scheme);
  scheme_.restore(scheme);
  if (accelerator_) accelerator_->load(file, unknown_->order(true));
  if (volume_level_) volume_level_->load(file, sides_);
  for (const Partner& partner : partners_)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partner.channel.get())) foreign->load(file);
  const std::vector<double> errors = file.read_common("errors");
  if (errors_) errors_->restore(errors);
  const std::vector<double> lag = file.read_common("lag");
  if (lag_) lag_->restore(lag);
  if (lag_ && !lag.empty())
    for (std::size_t k = 0; auto* field : lag_->fields())
      *field = file.read_or_none(order.rider, "lag-" + std::to_string(k++), 1);
  const app::RunState state = app::read_run_state(folders_.restart);
  loop_.restart(state, folders_.restart);
  ask_all(everyone(), {coupling::Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

}  // namespace couplet::coupler
