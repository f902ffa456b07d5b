// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign_structure.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet {
namespace {

using Datum = Interface::Datum;

std::vector<Datum>::iterator named(std::vector<Datum>& data, const std::string& name) {
  return std::ranges::find(data, name, &Datum::name);
}

[[noreturn]] void refuse(const char* key, const std::string& who, const char* does, const std::string& wanted,
                         const std::vector<Datum>& announced) {
  std::vector<std::string> all;
  for (const Datum& d : announced)
    all.push_back(fmt::format("'{}' [{}] at {}", d.name, d.unit,
                              d.place == Interface::Place::vertices ? "vertices" : "faces"));
  throw Error("coupling.structure.{}: '{}' {} no {}. It {}: {}.", key, who, does, wanted, does,
              all.empty() ? "nothing" : join(all));
}

void rename(std::map<std::string, int>& surface_of, const std::string& from, const std::string& to) {
  if (auto node = surface_of.extract(from); !node.empty()) {
    node.key() = to;
    surface_of.insert(std::move(node));
  }
}

}  // namespace

void ForeignStructure::adapt(Interface& own, Surfaces& surfaces, const std::vector<Interface>& all) {
  adapt_displacement(own, surfaces);
  n_values_ = own.vertices.size() * std::size_t(own.dim);
  if (!names_.load.empty()) adapt_load(own, surfaces, all);
}

void ForeignStructure::adapt_displacement(Interface& own, Surfaces& surfaces) {
  const auto datum = named(own.gives, names_.displacement);
  if (datum == own.gives.end() || datum->place != Interface::Place::vertices ||
      datum->size(own.dim) != own.dim || (datum->unit != "m" && datum->unit != "1"))
    refuse("displacement", name(), "gives",
           fmt::format("vector '{}' [m, or without a unit] at vertices", names_.displacement), own.gives);
  datum->name = "displacement", datum->unit = "m";
  rename(surfaces.gives, names_.displacement, "displacement");
  derives_velocity_ = named(own.gives, "velocity") == own.gives.end();
  if (!derives_velocity_) return;
  own.gives.push_back({"velocity", "m/s", Interface::Place::vertices});
  if (const auto surface = surfaces.gives.find("displacement"); surface != surfaces.gives.end())
    surfaces.gives["velocity"] = surface->second;
}

void ForeignStructure::adapt_load(Interface& own, Surfaces& surfaces, const std::vector<Interface>& all) {
  const auto datum = named(own.takes, names_.load);
  if (datum == own.takes.end() || datum->unit != "N" || datum->size(own.dim) != own.dim)
    refuse("load", name(), "takes", fmt::format("force '{}' [N]", names_.load), own.takes);
  for (const Interface& other : all)
    for (const Datum& given : other.gives)
      if (given.unit == "N" && given.size(other.dim) == own.dim &&
          std::ranges::find(forces_, given.name) == forces_.end())
        forces_.push_back(given.name);
  const Datum load = *datum;
  own.takes.erase(datum);
  for (const std::string& force : forces_) {
    own.takes.push_back({force, "N", load.place});
    if (const auto surface = surfaces.takes.find(load.name); surface != surfaces.takes.end())
      surfaces.takes[force] = surface->second;
  }
}

void ForeignStructure::send(const Command& command) {
  if (command.op == Op::begin_step) dt_ = command.step.dt;
  if (command.op == Op::accept_step) {
    older_ = now_.empty() ? std::vector<double>(next_.size()) : std::move(now_);
    now_ = next_;
    old_dt_ = dt_;
  }
  if (forces_.empty() || command.data.empty()) return channel_->send(command);
  Command own = command;
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

void ForeignStructure::save(CheckpointWriter& file) const {
  if (!derives_velocity_) return;
  file.write(name() + "-displacement", now_);
  file.write(name() + "-displacement-before", older_);
  file.write_scalar(name() + "-dt", dt_);
  file.write_scalar(name() + "-dt-before", old_dt_);
}

void ForeignStructure::load(CheckpointReader& file) {
  if (!derives_velocity_) return;
  now_ = file.read_or_none(name() + "-displacement", n_values_);
  older_ = file.read_or_none(name() + "-displacement-before", n_values_);
  dt_ = file.read_scalar(name() + "-dt");
  old_dt_ = file.read_scalar(name() + "-dt-before");
}

Reply ForeignStructure::receive() {
  Reply reply = channel_->receive();
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

}  // namespace couplet
