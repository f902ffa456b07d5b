// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"

namespace couplet::coupling {

/// One datum that a role asks for.
struct Demand {
  std::string what;  ///< for messages: "'displacement'", "load"
  std::string name;  ///< empty: any datum of one of the units
  std::vector<std::string> units;
  Interface::Place place;
  bool any_size = false;   ///< else a vector, a value for each dimension
  bool any_place = false;  ///< at vertices, too
};

/// What a role of a coupling asks of whoever plays it: what it takes from the coupler and what it gives to it.
struct RoleContract {
  std::string role;  ///< its key in `coupling`: fluid, structure, mesh
  std::vector<Demand> takes, gives;
  bool gives_nothing = false;  ///< to the coupler: what it finds goes to the fluid, rank to rank
};
/// fluid, structure, mesh.
const std::vector<RoleContract>& role_contracts();
const RoleContract& contract_of(const std::string& role);

/// What one of the project's programs can take and give at an interface (a case may need only a part of it), and the
/// link between a mesh mover and the fluid that it serves. Other programs are judged by what they announce.
struct Player {
  std::string program;
  std::vector<Interface::Datum> takes, gives;
  bool moves_mesh = false;  ///< sends the points of a moved mesh to a fluid, rank to rank
  bool mesh_moves = false;  ///< takes them
};
const std::vector<Player>& players();
/// Null for a program that is none of the project's.
const Player* player_of(const std::string& program);

/// Why somebody with these data cannot play the role; empty: it can. The role's contract is part of the sentence.
std::string problem_of_role(const RoleContract& contract, const std::vector<Interface::Datum>& takes,
                            const std::vector<Interface::Datum>& gives);
/// The same of one of the project's programs, with the link of the mesh. `has_mover`: the fluid's mesh is moved.
std::string problem_of_role(const RoleContract& contract, const Player& player, bool has_mover);

/// "takes 'displacement' [m] at vertices and gives a load [N] at faces"
std::string text(const RoleContract& contract);

}  // namespace couplet::coupling
