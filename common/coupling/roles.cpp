// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/roles.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace couplet::coupling {
namespace {

using Datum = Interface::Datum;
using Place = Interface::Place;

const Demand displacement{"'displacement'", "displacement", {"m"}, Place::vertices};
const Demand velocity{"'velocity'", "velocity", {"m/s"}, Place::vertices};

bool meets(const Demand& demand, const Datum& datum) {
  // A vector may also be declared by its number of components; Links checks it.
  const bool fits = demand.any_size || datum.components != 1;
  return fits && (demand.name.empty() || demand.name == datum.name) &&
         std::ranges::find(demand.units, datum.unit) != demand.units.end() &&
         (demand.any_place || demand.place == datum.place);
}

std::string text(const Demand& demand) {
  return fmt::format("{} [{}] at {}", demand.what, base::join(demand.units, " or "),
                     demand.any_place                  ? "faces or vertices"
                     : demand.place == Place::vertices ? "vertices"
                                                       : "faces");
}

std::string text(const std::vector<Demand>& demands) {
  std::vector<std::string> words;
  for (const Demand& demand : demands) words.push_back((demand.name.empty() ? "a " : "") + text(demand));
  return base::join(words, " and ");
}

std::string text(const std::vector<Datum>& data) {
  std::vector<std::string> words;
  for (const Datum& datum : data)
    words.push_back(fmt::format("'{}' [{}] at {}", datum.name, datum.unit,
                                datum.place == Place::vertices ? "vertices" : "faces"));
  return words.empty() ? "nothing" : base::join(words);
}

/// First demand that none of the data meets.
const Demand* unmet(const std::vector<Demand>& demands, const std::vector<Datum>& data) {
  for (const Demand& demand : demands)
    if (std::ranges::none_of(data, [&](const Datum& datum) { return meets(demand, datum); })) return &demand;
  return nullptr;
}

}  // namespace

const std::vector<RoleContract>& role_contracts() {
  static const std::vector<RoleContract> contracts{
      {"fluid", {displacement}, {{"load", "", {"N"}, Place::faces}}},
      {"structure", {{"load", "", {"N", "Pa"}, Place::faces, true, true}}, {displacement, velocity}},
      {"mesh", {displacement}, {}, true}};
  return contracts;
}

const RoleContract& contract_of(const std::string& role) {
  const auto found = std::ranges::find(role_contracts(), role, &RoleContract::role);
  if (found == role_contracts().end()) throw Error("The coupling has no role '{}'.", role);
  return *found;
}

const std::vector<Player>& players() {
  static const std::vector<Datum> motion{{"displacement", "m", Place::vertices},
                                         {"velocity", "m/s", Place::vertices}},
      loads{{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};
  static const std::vector<Player> list{
      {"fluid_solver", motion, loads, false, true},
      {"solid_solver", loads, motion},
      {"plate_modal", loads, motion},
      {"mesh_mover", {motion.front()}, {}, true},
      {"thermocline",
       {motion.front()},
       {{"temperature", "K", Place::faces, 1}, {"pressure", "Pa", Place::faces, 1}}}};
  return list;
}

const Player* player_of(const std::string& program) {
  const auto found = std::ranges::find(players(), program, &Player::program);
  return found == players().end() ? nullptr : &*found;
}

std::string text(const RoleContract& contract) {
  return fmt::format(
      "takes {} and gives {}", text(contract.takes),
      contract.gives_nothing ? "only the points of the fluid's moved mesh" : text(contract.gives));
}

std::string problem_of_role(const RoleContract& contract, const std::vector<Datum>& takes,
                            const std::vector<Datum>& gives) {
  const Demand *to_take = unmet(contract.takes, takes), *to_give = unmet(contract.gives, gives);
  if (to_take || to_give)
    return fmt::format("the role '{}' {}; it {} no {} (it takes {} and gives {})", contract.role,
                       text(contract), to_take ? "takes" : "gives", text(to_take ? *to_take : *to_give),
                       text(takes), text(gives));
  if (contract.gives_nothing && !gives.empty())
    return fmt::format("the role '{}' {}; it gives {}", contract.role, text(contract), text(gives));
  return "";
}

std::string problem_of_role(const RoleContract& contract, const Player& player, bool has_mover) {
  if (const std::string problem = problem_of_role(contract, player.takes, player.gives); !problem.empty())
    return problem;
  if (contract.gives_nothing && !player.moves_mesh) return "it moves no mesh";
  if (contract.role == "fluid" && has_mover && !player.mesh_moves) return "its mesh cannot be moved";
  return "";
}

}  // namespace couplet::coupling
