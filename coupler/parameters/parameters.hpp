// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/config/section.hpp"
#include "common/coupling/participant.hpp"

namespace couplet::coupler {

struct AccelerationParameters {
  enum class Type { constant, aitken, iqn_ils } type = Type::iqn_ils;
  double initial_relaxation = 0.5;
  int reused_steps = 8;  // quasi-Newton: number of earlier steps with stored differences
  double filter = 1e-3;  // limit of the independent part of a column
};

struct ConvergenceParameters {
  double relative = 1e-4;  // |r|_2 / |H(x) - x^n|_2
  /// Part of |H(x)| that counts as a change in any step: participants solve to about 1e-8 of their values.
  double least_change() const { return std::min(1., 1e-7 / relative); }
  double absolute = 0;  // rms of |r| over the vertices [m]
  int max_iterations = 50;
  bool accepts_at_maximum = false;  // without convergence; otherwise the step fails
};

struct MappingParameters {
  enum class Type { matched, nearest, projection } type = Type::matched;
  std::optional<double> tolerance;  // [m]
};

/// Integral over an interface.
struct IntegralParameters {
  std::string participant, data;
};

/// Participants of any kind that exchange data once per step, instead of fluid, structure and mesh.
struct ExchangeParameters {
  enum class Order { serial, parallel, structure_first };
  std::vector<std::string> participants;
  Order order = Order::serial;
  std::string digest;  // of the preCICE configuration that the case was created from; else empty
};

struct CouplingParameters {
  /// `adapts`: auto, implicit from the first step that requires it (see SchemeChoice).
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
  /// Names of displacement and load in the program; empty for Couplet's names.
  struct FluidRole : Role {
    std::string displacement{}, load{};
    bool foreign() const { return !displacement.empty() || !load.empty(); }
  };
  struct StructureRole : Role {
    // Names in its program; load: the sum of all forces.
    std::string displacement = "displacement", load{};
    bool foreign() const { return displacement != "displacement" || !load.empty(); }
  };
  std::optional<FluidRole> fluid;
  std::optional<Role> mesh;
  std::optional<StructureRole> structure;
  using Exchange = ExchangeParameters;
  std::optional<Exchange> exchange;
  AccelerationParameters acceleration;
  ConvergenceParameters convergence;
  /// Without exchange: order of fluid and structure, in sequence or in parallel.
  Exchange::Order order = Exchange::Order::serial;
  std::optional<double> predictor_order;
  std::map<std::string, double> sub_steps;  // by participant
  bool mesh_on_guess = false;               // in each pass of the implicit scheme
  bool loads_at_rest = false;               // on the undeformed surface of a linear structure; not a key
  MappingParameters mapping;
  std::map<std::string, IntegralParameters> watch;
  /// True if a mesh mover moves bodies of a fluid as prescribed: nothing is iterated then.
  bool moves_alone() const { return fluid && mesh && !structure && !exchange; }
  /// Copy with the effective scheme: one pass if nothing is iterated.
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
