// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_roles.hpp"

#include <algorithm>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/coupling/roles.hpp"

namespace couplet::app {
namespace {

class Cast {
 public:
  Cast(const config::Document& document, const std::vector<Expected>& expected) : document_(document) {
    for (const Expected& e : expected)
      if (e.participant != coupler_name) players_.push_back(e), names_.push_back(e.participant);
    has_mover_ = config::text_of(document, "coupling.mesh.participant").has_value();
  }

  std::vector<std::string> problems() {
    for (const coupling::RoleContract& contract : coupling::role_contracts()) look_at_role(contract);
    look_at_exchange();
    look_at_moved_walls();
    for (const Expected& e : players_) {
      if (e.program == "coupler")
        say("participants." + e.participant + ".program",
            "the coupler is not a participant; its keys are in `coupling`");
      else if (!in_cast(e.participant))
        problems_.push_back(fmt::format(
            "{}: this participant has no role in `coupling` (fluid, structure, mesh or exchange): assign "
            "one, or remove the participant.",
            config::where(document_, "participants." + e.participant)));
    }
    return problems_;
  }

 private:
  void say(const std::string& key, const std::string& what) {
    problems_.push_back(fmt::format("{}: {}.", config::where(document_, key), what));
  }
  bool in_cast(const std::string& name) const { return std::ranges::find(cast_, name) != cast_.end(); }
  const Expected* find(const std::string& name) const {
    const auto found = std::ranges::find(players_, name, &Expected::participant);
    return found == players_.end() ? nullptr : &*found;
  }
  void unknown(const std::string& key, const std::string& name) {
    problems_.push_back(fmt::format("{}: there is no participant '{}'. {}", config::where(document_, key),
                                    name, base::did_you_mean(name, names_, "participants")));
  }

  /// "; 'solid' (solid_solver) can": those of the case that could play it.
  std::string others(const coupling::RoleContract& contract) const {
    std::vector<std::string> able;
    for (const Expected& e : players_)
      if (const coupling::Player* player = coupling::player_of(e.program);
          player && coupling::problem_of_role(contract, *player, has_mover_).empty())
        able.push_back(fmt::format("'{}' ({})", e.participant, e.program));
    return able.empty() ? "" : fmt::format(". In this case {} can", base::join(able));
  }

  void look_at_role(const coupling::RoleContract& contract) {
    const std::string key = "coupling." + contract.role + ".participant";
    const auto name = config::text_of(document_, key);
    if (!name) return;
    cast_.push_back(*name);
    const Expected* who = find(*name);
    if (who == nullptr) return unknown(key, *name);
    if (who->program == "?") return;  // told elsewhere
    const coupling::Player* player = coupling::player_of(who->program);
    // Strangers show at the start what they take and give, but the link of the mesh is the project's own.
    std::string problem;
    if (player)
      problem = coupling::problem_of_role(contract, *player, has_mover_);
    else if (contract.gives_nothing)
      problem = "only mesh_mover can move the mesh of a fluid";
    else if (contract.role == "fluid" && has_mover_)
      problem =
          "only fluid_solver accepts a moved mesh; your own fluid program must move its mesh itself, "
          "without `mesh`";
    if (!problem.empty())
      say(key, fmt::format("'{}' is run by {}, which cannot be the {}: {}{}", *name, who->program,
                           contract.role, problem, others(contract)));
  }

  void look_at_exchange() {
    const std::string key = "coupling.exchange.participants";
    const auto exchanging = config::texts_of(document_, key);
    for (auto here = exchanging.begin(); here != exchanging.end(); ++here) {
      cast_.push_back(*here);
      const Expected* who = find(*here);
      if (who == nullptr) unknown(key, *here);
      if (std::find(exchanging.begin(), here, *here) != here)
        problems_.push_back(fmt::format("{}: '{}' is listed twice.", config::where(document_, key), *here));
      const coupling::Player* player = who ? coupling::player_of(who->program) : nullptr;
      if (player && player->moves_mesh)
        say(key,
            fmt::format(
                "'{}' is run by {}, which cannot be part of an exchange: it serves one fluid and gives the "
                "coupler no data; name it as `mesh` and its fluid as `fluid`",
                *here, who->program));
    }
  }

  /// Of a fluid and its mesh mover, which name the same patches: a wall that the structure moves is moved.
  void look_at_moved_walls() {
    const auto fluid = config::text_of(document_, "coupling.fluid.participant"),
               mover = config::text_of(document_, "coupling.mesh.participant");
    const Expected *moved = fluid ? find(*fluid) : nullptr, *moves = mover ? find(*mover) : nullptr;
    if (!moved || !moves || moved->program != "fluid_solver" || moves->program != "mesh_mover") return;
    const std::string walls = "participants." + *fluid + ".boundaries";
    for (const std::string& patch : config::keys_of(document_, walls)) {
      const std::string key = fmt::format("participants.{}.boundaries.{}.type", *mover, patch);
      const auto type = config::text_of(document_, key);
      const auto wall = config::text_of(document_, walls + "." + patch + ".type");
      if (!type || !wall) continue;
      if (*wall == "body" && *type != "moving")
        say(key,
            fmt::format(
                "the wall '{}' is a body in '{}', which the mesh mover must move: set `type: moving` with "
                "its `motion`",
                patch, *fluid));
      if (*wall == "no-slip" && *type == "moving")
        say(walls + "." + patch + ".type",
            fmt::format("the wall '{}' is moved by '{}', but in '{}' it is at rest: set `type: body`", patch,
                        *mover, *fluid));
      if (*wall != "interface" || *type == "interface") continue;
      say(key,
          fmt::format("'{}' holds the wall '{}' fixed by `type: {}`, but in '{}' it is an interface that the "
                      "structure moves, so the mesh would not follow. Set `type: interface`",
                      *mover, patch, *type, *fluid));
    }
  }

  const config::Document& document_;
  std::vector<Expected> players_;
  std::vector<std::string> names_, cast_, problems_;
  bool has_mover_ = false;
};

}  // namespace

std::vector<std::string> problems_of_roles(const config::Document& document,
                                           const std::vector<Expected>& expected) {
  return Cast(document, expected).problems();
}

}  // namespace couplet::app
