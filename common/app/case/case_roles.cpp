// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/case_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
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
    for (const coupling::RoleContract& contract : coupling::role_contracts()) check_role(contract);
    check_exchange();
    check_moved_walls();
    check_sub_steps();
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

  /// Text "; 'solid' (solid_solver) can" with the participants of the case that could play the role.
  std::string others(const coupling::RoleContract& contract) const {
    std::vector<std::string> able;
    for (const Expected& e : players_)
      if (const coupling::Player* player = coupling::player_of(e.program);
          player && coupling::problem_of_role(contract, *player, has_mover_).empty())
        able.push_back(fmt::format("'{}' ({})", e.participant, e.program));
    return able.empty() ? "" : fmt::format(". In this case {} can", base::join(able));
  }

  void check_role(const coupling::RoleContract& contract) {
    const std::string key = "coupling." + contract.role + ".participant";
    const auto name = config::text_of(document_, key);
    if (!name) return;
    cast_.push_back(*name);
    const Expected* who = find(*name);
    if (who == nullptr) return unknown(key, *name);
    if (who->program == "?") return;  // reported elsewhere
    check_interface(*who);
    const coupling::Player* player = coupling::player_of(who->program);
    // Other programs declare their data at the start, but only the project's own programs have the mesh link.
    std::string problem;
    if (player)
      problem = coupling::problem_of_role(contract, *player, has_mover_);
    else if (contract.gives_nothing)
      problem = "only mesh_mover can move the mesh of a fluid";
    else if (contract.role == "fluid" && has_mover_)
      problem =
          "only fluid_solver accepts a moved mesh; your own fluid program must move its mesh itself, without `mesh`";
    if (!problem.empty())
      say(key, fmt::format("'{}' is run by {}, which cannot be the {}: {}{}", *name, who->program,
                           contract.role, problem, others(contract)));
  }

  /// Programs whose boundary meets another participant only at patches of type interface need one. A fluid
  /// whose walls move by themselves has no structure.
  void check_interface(const Expected& who) {
    if (who.program != "solid_solver" &&
        !(who.program == "fluid_solver" && config::text_of(document_, "coupling.structure.participant")))
      return;
    const std::string key = "participants." + who.participant + ".boundaries";
    const std::vector<std::string> patches = config::keys_of(document_, key);
    const bool has_any = std::ranges::any_of(patches, [&](const std::string& patch) {
      return config::text_of(document_, key + "." + patch + ".type") == "interface";
    });
    if (!patches.empty() && !has_any)
      say(key,
          fmt::format(
              "'{}' is coupled, but none of its patches is an interface: set `type: interface` where it meets the other participant",
              who.participant));
  }

  void check_exchange() {
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

  /// The added mass acts on the change of the velocity over the whole step, but a structure with sub-steps vibrates
  /// within it: a light one diverges.
  void check_sub_steps() {
    const auto fluid = config::text_of(document_, "coupling.fluid.participant"),
               structure = config::text_of(document_, "coupling.structure.participant");
    const Expected *flow = fluid ? find(*fluid) : nullptr, *body = structure ? find(*structure) : nullptr;
    if (!flow || !body || !coupling::player_of(flow->program) || !coupling::player_of(body->program)) return;
    const std::string key = "coupling.sub-steps." + body->participant;
    if (const auto steps = config::text_of(document_, key); steps && *steps != "1")
      say(key,
          fmt::format(
              "{} does not support sub-steps when coupled with {}: the fluid's added mass acts on the change of velocity over "
              "the whole step; use a smaller `simulation.time-step`",
              body->program, flow->program));
  }

  /// Checks that a fluid and its mesh mover name the same patches: a wall moved by the structure must move.
  void check_moved_walls() {
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
                "the wall '{}' is a body in '{}', which the mesh mover must move: set `type: moving` with its `motion`",
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

namespace {

// A structure wetted on one side carries the whole mass. A smaller value converges better with heavy fluids.
constexpr double most = 3;

/// Value of a key in SI. Nothing if it is absent or invalid, which is reported elsewhere.
std::optional<double> number(const config::Document& document, const std::string& key, const char* unit) {
  const auto text = config::text_of(document, key);
  if (!text) return {};
  try {
    return base::parse_quantity(*text, unit);
  } catch (const Error&) {
    return {};
  }
}

/// Largest density times thickness of the plate and its zones [kg/m^2].
double mass_of(const config::Document& document, const std::string& plate) {
  const auto density = number(document, plate + ".material.density", "kg/m^3"),
             thickness = number(document, plate + ".thickness", "m");
  double largest = density.value_or(0) * thickness.value_or(0);
  for (const std::string& zone : config::keys_of(document, plate + ".zones")) {
    const std::string key = plate + ".zones." + zone;
    const auto own_density = number(document, key + ".density", "kg/m^3"),
               own_thickness = number(document, key + ".thickness", "m");
    largest = std::max(
        largest, own_density.value_or(density.value_or(0)) * own_thickness.value_or(thickness.value_or(0)));
  }
  return largest;
}

}  // namespace

std::vector<std::string> check_wall_mass(const config::Document& document) {
  const auto fluid = config::text_of(document, "coupling.fluid.participant"),
             structure = config::text_of(document, "coupling.structure.participant");
  if (!fluid || !structure) return {};
  const std::string plate = "participants." + *structure;
  if (config::text_of(document, plate + ".program") != "plate_modal") return {};
  const double mass = mass_of(document, plate);
  if (!(mass > 0)) return {};
  std::vector<std::string> doubts;
  const std::string walls = "participants." + *fluid + ".boundaries";
  for (const std::string& patch : config::keys_of(document, walls)) {
    const std::string key = fmt::format("{}.{}.surface-density", walls, patch);
    if (const auto given = number(document, key, "kg/m^2"); given && *given > most * mass)
      doubts.push_back(fmt::format(
          "{}: {:.6g} kg/m^2, but density times thickness of the plate '{}' is {:.3g} kg/m^2: implausible; check the number "
          "and its unit.",
          config::where(document, key), *given, *structure, mass));
  }
  return doubts;
}

namespace {

class ContactSeat {
 public:
  ContactSeat(config::Document& document, std::string contact)
      : document_(document), contact_(std::move(contact)), keys_(config::keys_of(document, contact_)) {}

  std::vector<std::string> problems() {
    const auto fluid = config::text_of(document_, "coupling.fluid.participant");
    const std::string gaps = fluid ? "participants." + *fluid + ".gaps" : "";
    const std::vector<std::string> names =
        fluid ? config::keys_of(document_, gaps) : std::vector<std::string>();
    if (has("gap"))
      take(*config::text_of(document_, contact_ + ".gap"), gaps, names);
    else
      search_beside(gaps, names);
    return problems_;
  }

 private:
  bool has(const char* key) const { return std::ranges::find(keys_, key) != keys_.end(); }
  void say(const std::string& key, const std::string& what) {
    problems_.push_back(fmt::format("{}: {}.", config::where(document_, contact_ + "." + key), what));
  }

  void take(const std::string& name, const std::string& gaps, const std::vector<std::string>& names) {
    if (gaps.empty()) return say("gap", "it refers to a gap of a fluid, but no fluid is coupled");
    if (std::ranges::find(names, name) == names.end())
      return say("gap", "the fluid has no gap '" + name + "'. " + base::did_you_mean(name, names, "gaps"));
    for (const char* key : {"height", "opening", "direction"})
      if (has(key)) say(key, fmt::format("the gap '{}' already defines it; remove it here", name));
    if (!problems_.empty()) return;
    const std::string gap = gaps + "." + name;
    const auto height = config::text_of(document_, gap + ".height"),
               opening = config::text_of(document_, gap + ".opening");
    if (!height) return say("gap", fmt::format("the gap '{}' needs the 'height' of its seat", name));
    set("height", '"' + *height + '"');
    if (opening) set("opening", *opening);
    const std::vector<std::string> direction = config::texts_of(document_, gap + ".direction");
    if (!direction.empty()) set("direction", fmt::format("[{}]", fmt::join(direction, ", ")));
  }

  /// Reports a gap and a contact that both specify the seat.
  void search_beside(const std::string& gaps, const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (config::text_of(document_, gaps + "." + name + ".height"))
        return say("height",
                   fmt::format("the gap '{0}' of the fluid states a seat as well: use 'gap: {0}' in "
                               "place of 'height' here, or remove its 'height'",
                               name));
  }

  void set(const char* key, const std::string& value) {
    document_.set(fmt::format("{}.{}={}", contact_, key, value));
  }

  config::Document& document_;
  const std::string contact_;
  const std::vector<std::string> keys_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> share_seats(config::Document& document) {
  const auto structure = config::text_of(document, "coupling.structure.participant");
  if (!structure) return {};
  const std::string contact = "participants." + *structure + ".contact";
  if (config::keys_of(document, contact).empty()) return {};
  return ContactSeat(document, contact).problems();
}

}  // namespace couplet::app
