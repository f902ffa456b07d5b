// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/foreign_fluid.hpp"

#include <fmt/format.h>

#include "coupler/exchange/foreign_names.hpp"

namespace couplet::coupler {

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
