// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet::coupler {

using Datum = coupling::Interface::Datum;

std::vector<Datum>::iterator ForeignNames::find(const std::string& name) const {
  return std::ranges::find(data, name, &Datum::name);
}

void ForeignNames::rename(Datum& datum, const std::string& name) const {
  if (auto node = surface_of.extract(datum.name); !node.empty()) {
    node.key() = name;
    surface_of.insert(std::move(node));
  }
  datum.name = name;
}

void ForeignNames::put_beside(const std::string& datum, const std::string& name) const {
  if (const auto surface = surface_of.find(datum); surface != surface_of.end())
    surface_of[name] = surface->second;
}

void ForeignNames::refuse(const char* key, const std::string& wanted) const {
  std::vector<std::string> all;
  for (const Datum& d : data)
    all.push_back(fmt::format("'{}' [{}] at {}", d.name, d.unit,
                              d.place == coupling::Interface::Place::vertices ? "vertices" : "faces"));
  throw Error("coupling.{}.{}: '{}' {} no {}. It {}: {}.", role, key, who, does, wanted, does,
              all.empty() ? "nothing" : base::join(all));
}

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

/// Derivative at t^{n+1} of the parabola through the last three displacements, or of the line through two.
std::vector<double> ForeignStructure::velocity() const {
  const bool parabola = !older_.empty() && old_dt_ > 0;
  const double r = parabola ? dt_ / old_dt_ : 0, newest = (1 + 2 * r) / (1 + r) / dt_, last = -(1 + r) / dt_,
               oldest = r * r / (1 + r) / dt_;
  std::vector<double> v(next_.size());
  for (std::size_t i = 0; i < v.size(); ++i)
    v[i] = newest * next_[i] + (now_.empty() ? 0 : last * now_[i]) + (parabola ? oldest * older_[i] : 0);
  return v;
}

void ForeignStructure::visit(io::Archive& archive) {
  if (!derives_velocity_) return;
  const auto order = parallel::GlobalOrder::as_they_are(archive.comm(), n_values_);
  archive.field(order, name() + "-displacement", now_, 1);
  archive.field(order, name() + "-displacement-before", older_, 1);
  archive.common(name() + "-steps", dt_, old_dt_);
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

void ForeignFluid::adapt(coupling::Interface& own, coupling::Surfaces& surfaces) {
  const ForeignNames takes{own.takes, surfaces.takes, "fluid", name(), "takes"},
      gives{own.gives, surfaces.gives, "fluid", name(), "gives"};
  const auto motion = takes.find(names_.displacement);
  if (motion == own.takes.end() || motion->size(own.dim) != own.dim ||
      (motion->unit != "m" && motion->unit != "1"))
    takes.refuse("displacement", fmt::format("vector '{}' [m, or without a unit]", names_.displacement));
  takes.rename(*motion, "displacement");
  motion->unit = "m";
  const auto force = gives.find(names_.load);
  if (force == own.gives.end() || force->unit != "N" || force->size(own.dim) != own.dim)
    gives.refuse("load", fmt::format("force '{}' [N]", names_.load));
  gives.rename(*force, "pressure-force");
  coupling::Interface::Datum viscous = *force;
  viscous.name = "viscous-force";
  own.gives.push_back(viscous);
  gives.put_beside("pressure-force", "viscous-force");
}

void ForeignFluid::send(const coupling::Command& command) {
  if (!command.data.contains("displacement")) return channel_->send(command);
  coupling::Command own = command;
  auto node = own.data.extract("displacement");
  node.key() = names_.displacement;
  own.data.insert(std::move(node));
  channel_->send(own);
}

coupling::Reply ForeignFluid::receive() {
  coupling::Reply reply = channel_->receive();
  if (auto node = reply.data.extract(names_.load); !node.empty()) {
    reply.data["viscous-force"] = std::vector<double>(node.mapped().size());
    node.key() = "pressure-force";
    reply.data.insert(std::move(node));
  }
  return reply;
}

}  // namespace couplet::coupler
