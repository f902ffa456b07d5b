// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "xml.hpp"

namespace couplet::dropin {

/// Data of a configuration for one participant.
struct Configuration {
  struct Mesh {
    std::string name;
    int dimensions = 3;
    bool provided = false;            ///< by this participant; otherwise received and known only by name
    bool needs_connectivity = false;  ///< some mapping projects onto it
  };
  /// Datum that the program reads or writes on one of its meshes.
  struct Data {
    std::string mesh, name;
    bool vector = false, written = false;
  };
  /// Connection of a datum between meshes of two participants, known to the coupler by its name.
  struct Wire {
    std::string name;
    std::size_t data = 0;  ///< index of this participant's data
    bool given = false, conservative = false;
    bool initialised = false;  ///< values exist before the first step
    bool held = false;         ///< constant over the window with the value at its start
    bool iterated = false;     ///< taken before it is given in a pass
    int degree = 1;            ///< of the interpolation in time within a window
    bool within = false;       ///< transferred with its values at sub-steps
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
  /// Returns true if others need data of this participant before the first step.
  bool writes_initial_data() const;
};

/// Reads `file`, the XML or the case that `couplet import` made of it. Throws precice::Error with file and
/// line, also for unsupported features.
Configuration read_configuration(const std::string& file, const std::string& participant);

}  // namespace couplet::dropin
