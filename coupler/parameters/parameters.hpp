// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/coupling/participant.hpp"

namespace couplet::coupler {

struct AccelerationParameters {
  enum class Type { constant, aitken, iqn_ils, iqn_mvj } type = Type::iqn_ils;
  double initial_relaxation = 0.5;
  double maximum_relaxation = 1.0;
  int reused_steps = 8;       // quasi-Newton: earlier steps whose differences are kept
  int maximum_columns = 100;  // of these differences
  double filter = 1e-3;       // of what is independent in a column
};

struct ConvergenceParameters {
  double relative = 1e-5;  // |r|_2 / |H(x)|_2
  double absolute = 0;     // rms of |r| over the vertices [m]
  bool both = false;       // not either
  int min_iterations = 1, max_iterations = 50;
  enum class AtMaximum { fail, accept } at_maximum = AtMaximum::fail;
};

struct MappingParameters {
  enum class Type { matched, nearest, projection, rbf } type = Type::matched;
  std::optional<double> tolerance;  // [m]
};

/// One integral over an interface.
struct WatchParameters {
  std::string participant, data;
  std::string part;  // of the interface; empty: all of it
};

/// Participants of any kind that exchange data once a step, in place of fluid, structure and mesh.
struct ExchangeParameters {
  enum class Order { serial, parallel, structure_first };
  std::vector<std::string> participants;
  Order order = Order::serial;
  std::string digest;  // of the configuration of preCICE that the case was made of; empty: it was not
};

struct CouplingParameters {
  /// `adapts`: auto, implicit from the step on that shows the need (see SchemeChoice).
  struct CaseScheme {
    coupling::Scheme first = coupling::Scheme::semi_implicit;
    bool adapts = true;
    CaseScheme() = default;
    CaseScheme(coupling::Scheme only)
        : first(only), adapts(false) {}  // NOLINT: a scheme is a scheme of a case
    bool operator==(const CaseScheme&) const = default;
    bool is_semi_implicit() const { return first == coupling::Scheme::semi_implicit; }
  } scheme;
  struct Role {
    std::string participant;
  };
  /// As its program calls its displacement and its load; empty: as this project does.
  struct Fluid : Role {
    std::string displacement{}, load{};
    bool foreign() const { return !displacement.empty() || !load.empty(); }
  };
  struct Structure : Role {
    std::string displacement = "displacement",
                load{};  // as its program calls them; load: the sum of all forces
    bool foreign() const { return displacement != "displacement" || !load.empty(); }
  };
  std::optional<Fluid> fluid;
  std::optional<Role> mesh;
  std::optional<Structure> structure;
  using Exchange = ExchangeParameters;
  std::optional<Exchange> exchange;
  AccelerationParameters acceleration;
  ConvergenceParameters convergence;
  /// Without exchange: fluid and structure one after the other, or side by side.
  Exchange::Order order = Exchange::Order::serial;
  std::optional<double> predictor_order;
  std::map<std::string, double> sub_steps;  // by participant
  enum class Waveform { linear, constant } waveform = Waveform::linear;
  bool mesh_on_guess = false;  // in each pass of the implicit scheme
  MappingParameters mapping;
  bool interface_output = false;  // for ParaView
  std::map<std::string, WatchParameters> watch;
  /// What follows when a guard finds that the coupling itself makes the motion.
  enum class OnDivergence { stop, warn } on_divergence = OnDivergence::stop;
  /// A fluid whose bodies the mesh mover moves as the case prescribes: there is no structure, nothing to iterate.
  bool moves_alone() const { return fluid && mesh && !structure && !exchange; }
  /// The same with the scheme that is in force: one pass where nothing is iterated.
  CouplingParameters in_force() const {
    CouplingParameters p = *this;
    if (moves_alone()) p.scheme = coupling::Scheme::explicit_;
    return p;
  }
};
void declare(config::Section& section, CouplingParameters& parameters);
void declare(config::Section& section, AccelerationParameters& parameters);
void declare(config::Section& section, ConvergenceParameters& parameters);
void declare(config::Section& section, MappingParameters& parameters);

}  // namespace couplet::coupler
