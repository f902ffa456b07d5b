// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/coupling/participant.hpp"
#include "coupler/mapping.hpp"
#include "coupler/predictor.hpp"

namespace couplet {

/// One participant as the coupler knows it after `initialise`.
struct Side {
  std::string name;
  Interface interface;
};

/// Sum of the forces and their work on one side of the interface.
struct Balance {
  Vec3 force = Vec3::Zero();  ///< [N]
  double work = 0;            ///< over the step [J]
};

/// Who gives what to whom: each datum that a side takes comes from the side that gives a datum of the same
/// name. Data at vertices (motion) go from the structure to the fluid and the mesh mover, consistently; data
/// at faces (load) from the fluid to the structure, conservatively.
class Wiring {
 public:
  /// Throws Error if a datum is taken and not given, units or dimensions differ, or the points do not match.
  Wiring(const Side& fluid, const Side& structure, const std::optional<Side>& mesh,
         const MappingParameters& mapping);

  int dim() const { return dim_; }
  const Side& fluid() const { return fluid_; }
  std::size_t n_unknowns() const { return structure_.interface.vertices.size() * std::size_t(dim_); }
  Exchange to_fluid(const InterfaceState& x) const { return motion(x, fluid_, *to_fluid_); }
  Exchange to_mesh(const InterfaceState& x) const { return motion(x, *mesh_, *to_mesh_); }
  Exchange to_structure(const Exchange& from_fluid) const;
  InterfaceState from_structure(Exchange data) const;

  /// From the forces [N] at faces in `data` and the displacement increment at the vertices of that side.
  Balance fluid_balance(const Exchange& data, const std::vector<double>& increment) const;
  Balance structure_balance(const Exchange& data, const std::vector<double>& increment) const;
  /// The structure's vertex values at the fluid's vertices.
  std::vector<double> at_fluid(const std::vector<double>& values) const {
    return to_fluid_->apply(values, dim_);
  }

  /// One sentence a mapping, and warnings about data that nobody takes.
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  Exchange motion(const InterfaceState& x, const Side& to, const Mapping& mapping) const;

  Side fluid_, structure_;
  std::optional<Side> mesh_;
  int dim_;
  std::optional<Mapping> to_fluid_, to_mesh_, to_structure_;
  SparseMap fluid_faces_, structure_faces_;  // from values at vertices to those at face centres
  std::vector<std::string> notes_;
};

}  // namespace couplet
