// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/participant.hpp"

namespace couplet::coupling {

/// Datum that a role requires.
struct Demand {
  std::string what;  ///< for messages: "'displacement'", "load"
  std::string name;  ///< empty if any datum with one of the units will do
  std::vector<std::string> units;
  Interface::Place place;
  bool any_size = false;   ///< otherwise it must be a vector with one value per dimension
  bool any_place = false;  ///< also accepted at vertices
};

/// Data that a role of a coupling receives from the coupler and returns to it.
struct RoleContract {
  std::string role;  ///< its key in `coupling`: fluid, structure, mesh
  std::vector<Demand> takes, gives;
  bool gives_nothing = false;  ///< to the coupler: results go to the fluid, rank to rank
};
/// Contracts of the roles fluid, structure and mesh.
const std::vector<RoleContract>& role_contracts();
const RoleContract& contract_of(const std::string& role);

/// Data that one of the project's programs can exchange at an interface (a case may need only some of them),
/// and its link between mesh mover and fluid. Other programs are judged by the data they announce.
struct Player {
  std::string program;
  std::vector<Interface::Datum> takes, gives;
  bool moves_mesh = false;  ///< sends the points of a moved mesh to a fluid, rank to rank
  bool mesh_moves = false;  ///< receives them
};
const std::vector<Player>& players();
/// Returns nullptr if the program is not one of the project's.
const Player* player_of(const std::string& program);

/// Reason why a program with these data cannot play the role, including the contract. Empty if it can.
std::string problem_of_role(const RoleContract& contract, const std::vector<Interface::Datum>& takes,
                            const std::vector<Interface::Datum>& gives);
/// Overload that also checks the mesh link of a program. `has_mover` is true if the fluid's mesh is moved.
std::string problem_of_role(const RoleContract& contract, const Player& player, bool has_mover);

/// Describes a contract: "takes 'displacement' [m] at vertices and gives a load [N] at faces".
std::string text(const RoleContract& contract);

}  // namespace couplet::coupling
