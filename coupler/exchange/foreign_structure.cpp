// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign_structure.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/io/checkpoint.hpp"
#include "coupler/exchange/foreign_names.hpp"

namespace couplet::coupler {

using Datum = coupling::Interface::Datum;

void ForeignStructure::adapt(coupling::Interface& own, coupling::Surfaces& surfaces,
                             const std::vector<coupling::Interface>& all) {
  adapt_displacement(own, surfaces);
  n_values_ = own.vertices.size() * std::size_t(own.dim);
  if (!names_.load.empty()) adapt_load(own, surfaces, all);
}

void ForeignStructure::adapt_displacement(coupling::Interface& own, coupling::Surfaces& surfaces) {
  const ForeignNames gives{own.gives, surfaces.gives, "structure", name(), "gives"};
  const auto datum = gives.find(names_.displacement);
  if (datum == own.gives.end() || datum->place != coupling::Interface::Place::vertices ||
      datum->size(own.dim) != own.dim || (datum->unit != "m" && datum->unit != "1"))
    gives.refuse("displacement",
                 fmt::format("vector '{}' [m, or without a unit] at vertices", names_.displacement));
  gives.rename(*datum, "displacement");
  datum->unit = "m";
  derives_velocity_ = gives.find("velocity") == own.gives.end();
  if (!derives_velocity_) return;
  own.gives.push_back({"velocity", "m/s", coupling::Interface::Place::vertices});
  gives.put_beside("displacement", "velocity");
}

void ForeignStructure::adapt_load(coupling::Interface& own, coupling::Surfaces& surfaces,
                                  const std::vector<coupling::Interface>& all) {
  const ForeignNames takes{own.takes, surfaces.takes, "structure", name(), "takes"};
  const auto datum = takes.find(names_.load);
  if (datum == own.takes.end() || datum->unit != "N" || datum->size(own.dim) != own.dim)
    takes.refuse("load", fmt::format("force '{}' [N]", names_.load));
  for (const coupling::Interface& other : all)
    for (const Datum& given : other.gives)
      if (given.unit == "N" && given.size(other.dim) == own.dim &&
          std::ranges::find(forces_, given.name) == forces_.end())
        forces_.push_back(given.name);
  const Datum load = *datum;
  own.takes.erase(datum);
  for (const std::string& force : forces_) {
    own.takes.push_back({force, "N", load.place});
    takes.put_beside(load.name, force);
  }
}

void ForeignStructure::send(const coupling::Command& command) {
  if (command.op == coupling::Op::begin_step) dt_ = command.step.dt;
  if (command.op == coupling::Op::accept_step) {
    older_ = now_.empty() ? std::vector<double>(next_.size()) : std::move(now_);
    now_ = next_;
    old_dt_ = dt_;
  }
  if (forces_.empty() || command.data.empty()) return channel_->send(command);
  coupling::Command own = command;
  std::vector<double> load;
  for (const std::string& force : forces_) {
    const auto node = own.data.extract(force);
    if (node.empty()) continue;
    load.resize(node.mapped().size());
    for (std::size_t i = 0; i < load.size(); ++i) load[i] += node.mapped()[i];
  }
  own.data[names_.load] = std::move(load);
  channel_->send(own);
}

/// The derivative at t^{n+1} of the parabola through the last three displacements; of the line through two in the first step.
std::vector<double> ForeignStructure::velocity() const {
  const bool parabola = !older_.empty() && old_dt_ > 0;
  const double r = parabola ? dt_ / old_dt_ : 0, newest = (1 + 2 * r) / (1 + r) / dt_, last = -(1 + r) / dt_,
               oldest = r * r / (1 + r) / dt_;
  std::vector<double> v(next_.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = newest * next_[i] + (now_.empty() ? 0 : last * now_[i]) + (parabola ? oldest * older_[i] : 0);
  return v;
}

void ForeignStructure::save(io::CheckpointWriter& file) const {
  if (!derives_velocity_) return;
  const auto order = parallel::GlobalOrder::as_they_are(file.comm(), n_values_);
  file.write(order, name() + "-displacement", now_);
  file.write(order, name() + "-displacement-before", older_);
  file.write_scalar(name() + "-dt", dt_);
  file.write_scalar(name() + "-dt-before", old_dt_);
}

void ForeignStructure::load(io::CheckpointReader& file) {
  if (!derives_velocity_) return;
  const auto order = parallel::GlobalOrder::as_they_are(file.comm(), n_values_);
  now_ = file.read_or_none(order, name() + "-displacement", 1);
  older_ = file.read_or_none(order, name() + "-displacement-before", 1);
  dt_ = file.read_scalar(name() + "-dt");
  old_dt_ = file.read_scalar(name() + "-dt-before");
}

coupling::Reply ForeignStructure::receive() {
  coupling::Reply reply = channel_->receive();
  if (auto node = reply.data.extract(names_.displacement); !node.empty()) {
    next_ = node.mapped();
    node.key() = "displacement";
    reply.data.insert(std::move(node));
    const bool before_the_start = dt_ == 0;
    if (before_the_start) now_ = next_;
    if (derives_velocity_)
      reply.data["velocity"] = before_the_start ? std::vector<double>(next_.size()) : velocity();
  }
  return reply;
}

}  // namespace couplet::coupler
