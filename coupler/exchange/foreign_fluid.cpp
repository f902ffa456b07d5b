// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign_fluid.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet {
namespace {

using Datum = Interface::Datum;

/// The vector of this name in one of these units.
Datum& vector_named(std::vector<Datum>& data, const std::string& datum, const std::vector<std::string>& units,
                    int dim, const char* key, const std::string& who, const char* does) {
  const auto found = std::ranges::find(data, datum, &Datum::name);
  if (found != data.end() && found->size(dim) == dim && std::ranges::find(units, found->unit) != units.end())
    return *found;
  std::vector<std::string> all;
  for (const Datum& d : data) all.push_back(fmt::format("'{}' [{}]", d.name, d.unit));
  throw Error("coupling.fluid.{}: '{}' {} no vector '{}' [{}]. It {}: {}.", key, who, does, datum,
              join(units, " or "), does, all.empty() ? "nothing" : join(all));
}

void carry_over(std::map<std::string, int>& surface_of, const std::string& from, const std::string& to) {
  if (auto node = surface_of.extract(from); !node.empty()) {
    node.key() = to;
    surface_of.insert(std::move(node));
  }
}

}  // namespace

void ForeignFluid::adapt(Interface& own, Surfaces& surfaces) {
  Datum& motion =
      vector_named(own.takes, names_.displacement, {"m", "1"}, own.dim, "displacement", name(), "takes");
  motion.name = "displacement", motion.unit = "m";
  carry_over(surfaces.takes, names_.displacement, "displacement");
  Datum& force = vector_named(own.gives, names_.load, {"N"}, own.dim, "load", name(), "gives");
  force.name = "pressure-force";
  carry_over(surfaces.gives, names_.load, "pressure-force");
  Datum viscous = force;
  viscous.name = "viscous-force";
  own.gives.push_back(viscous);
  if (const auto surface = surfaces.gives.find("pressure-force"); surface != surfaces.gives.end())
    surfaces.gives["viscous-force"] = surface->second;
}

void ForeignFluid::send(const Command& command) {
  if (!command.data.contains("displacement")) return channel_->send(command);
  Command own = command;
  auto node = own.data.extract("displacement");
  node.key() = names_.displacement;
  own.data.insert(std::move(node));
  channel_->send(own);
}

Reply ForeignFluid::receive() {
  Reply reply = channel_->receive();
  if (auto node = reply.data.extract(names_.load); !node.empty()) {
    reply.data["viscous-force"] = std::vector<double>(node.mapped().size());
    node.key() = "pressure-force";
    reply.data.insert(std::move(node));
  }
  return reply;
}

}  // namespace couplet
