// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "xml.hpp"

namespace couplet::dropin {

/// What a configuration says of one participant.
struct Configuration {
  struct Mesh {
    std::string name;
    int dimensions = 3;
    bool provided = false;            ///< by this participant; otherwise received, and only known by name
    bool needs_connectivity = false;  ///< a projection is made onto it
  };
  /// A datum that the program reads or writes on one of its meshes.
  struct Data {
    std::string mesh, name;
    bool vector = false, written = false;
  };
  /// A datum on its way from one mesh of one participant to one of another. The coupler knows it by its name.
  struct Wire {
    std::string name;
    std::size_t data = 0;  ///< of this participant
    bool given = false, conservative = false;
    bool initialised = false;  ///< the giver has values before the first step
    bool held = false;         ///< taken with the value at the start of the window, all through it
    bool iterated = false;     ///< taken before it is given in a pass
    int degree = 1;            ///< of the interpolation in time within a window
    bool within = false;       ///< goes over with its values at the sub-steps
  };
  std::string file, participant;
  std::vector<Mesh> meshes;
  std::vector<Data> data;
  std::vector<Wire> wires;
  bool implicit = false;
  /// To the coupler: digest of the XML, this participant's schemes (docs/protocol.md).
  std::string introduction;

  const Mesh* mesh(const std::string& name) const;
  const Data* find(const std::string& mesh, const std::string& name, bool written) const;
  /// This participant writes some that others need before the first step.
  bool writes_initial_data() const;
};

/// `file`: the XML, or the case that couplet import made of it. Throws precice::Error with file and line, also for what
/// is not supported.
Configuration read_configuration(const std::string& file, const std::string& participant);

}  // namespace couplet::dropin
