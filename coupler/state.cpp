// SPDX-License-Identifier: Apache-2.0
// What the coupler keeps over a restart.
#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "coupler/exchange/foreign_structure.hpp"

namespace couplet::coupler {
namespace {

void write(io::CheckpointWriter& file, const std::string& name, const Iterate& x) {
  file.write(name, x.unknown);
  file.write(name + "-rider", x.rider);
}

/// As much as the coupling has unknowns and values that ride along, or nothing.
Iterate read(io::CheckpointReader& file, const std::string& name, const Unknown& unknown) {
  return {file.read_or_none(name, unknown.n_unknown()),
          file.read_or_none(name + "-rider", unknown.n_rider())};
}

}  // namespace

void Coupler::save(const std::filesystem::path& folder) {
  enter_(app::Phase::save, {});
  ask_all(everyone(), {coupling::Op::save, {}, {}, 0, -1, folder.string()});
  io::CheckpointWriter file(comm_, folder / "coupler.h5");
  write(file, "now", history_.now);
  write(file, "old", history_.old);
  write(file, "older", history_.older);
  file.write_scalar("old-dt", history_.old_dt);
  file.write_scalar("older-dt", history_.older_dt);
  file.write("weights", unknown_->weights());
  for (std::size_t i = 0; i < mechanics_->walls().size(); ++i)
    file.write("wall-" + std::to_string(i), mechanics_->walls()[i]);
  file.write("work", work_guard_.totals());
  if (accelerator_) accelerator_->save(file);
  if (volume_level_) volume_level_->save(file);
  for (const Partner& partner : partners_)
    if (const auto* foreign = dynamic_cast<const ForeignStructure*>(partner.channel.get()))
      foreign->save(file);
  file.write("errors", errors_ ? errors_->state() : std::vector<double>{});
  file.write("lag", lag_ ? lag_->state() : std::vector<double>{});
  if (lag_)
    for (std::size_t k = 0; const auto* field : lag_->fields())
      file.write("lag-" + std::to_string(k++), *field);
  file.close();
}

void Coupler::load() {
  enter_(app::Phase::load, {});
  io::CheckpointReader file(comm_, folders_.restart / "coupler.h5");
  history_.now = read(file, "now", *unknown_);
  history_.old = read(file, "old", *unknown_);
  history_.older = read(file, "older", *unknown_);
  history_.old_dt = file.read_scalar("old-dt");
  history_.older_dt = file.read_scalar("older-dt");
  unknown_->restore_weights(file.read("weights"));
  for (std::size_t i = 0; i < mechanics_->walls().size(); ++i)
    file.read("wall-" + std::to_string(i), mechanics_->walls()[i]);
  std::array<double, 6> work{};
  file.read("work", work);
  work_guard_.restore(work);
  if (accelerator_) accelerator_->load(file);
  if (volume_level_) volume_level_->load(file);
  for (const Partner& partner : partners_)
    if (auto* foreign = dynamic_cast<ForeignStructure*>(partner.channel.get())) foreign->load(file);
  const std::vector<double> errors = file.read("errors");
  if (errors_) errors_->restore(errors);
  const std::vector<double> lag = file.read("lag");
  if (lag_) lag_->restore(lag);
  if (lag_ && !lag.empty())
    for (std::size_t k = 0; auto* field : lag_->fields())
      *field = file.read_or_none("lag-" + std::to_string(k++), unknown_->n_rider());
  const app::RunState state = app::read_run_state(folders_.restart);
  loop_.restart(state, folders_.restart);
  ask_all(everyone(), {coupling::Op::load, {}, {}, state.time, -1, folders_.restart.string()});
  log::info("continues from {} at t = {:g} s", folders_.restart.string(), state.time);
}

}  // namespace couplet::coupler
