// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/io/probes/probe.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"

namespace couplet::solid {

/// Owned cells that have the place at a corner, on a side or inside. Collective.
std::vector<Index> cells_at(const mesh::Mesh& mesh, const io::Probe& probe);

/// Materials that meet at a probe, ascending. Collective.
std::vector<int> materials_at(const mesh::Mesh& mesh, const io::Probe& probe);

/// A tensor at a probe.
struct Side {
  int material = 0;
  PackedTensor tensor{};
};
/// The side with the largest equivalent value among these materials, the same on all ranks. Collective.
Side worst_side_at(const io::Probe& probe, const std::vector<int>& materials, const SidedTensors& sides,
                   MPI_Comm comm);

/// Flags of these local points of all ranks, on each rank that shares one. Collective.
std::vector<std::uint8_t> flags_of(const mesh::Mesh& mesh, std::span<const Index> points);

/// The probes of a solid: which columns they fill, and their values.
class SolidProbes {
 public:
  /// Throws Error if a probe is outside or its field does not exist. Keeps references. Collective.
  SolidProbes(const SolidBody& body, const SolidFields& derived);
  bool empty() const { return probes_.empty(); }
  /// For example "tip x [m]", "tip velocity x [m/s]", "tip stress-xx [Pa]".
  const std::vector<std::string>& columns() const { return columns_; }
  /// Values per column at the accepted time on rank 0, empty elsewhere. `points`: displacement of all local
  /// points. Collective.
  std::vector<double> sample(std::span<const double> points) const;

  /// Stress at a probe.
  struct Stress {
    std::string probe;
    Vec3 place;
    double equivalent;  ///< von Mises [Pa]
    double left;        ///< StressRecovery::left_at_points() [1]
  };
  /// Stresses of the accepted state on rank 0, empty elsewhere. Collective.
  std::vector<Stress> stresses(const DiscreteStress& of) const;

 private:
  struct Watched {
    std::string name;
    io::Probe probe;
    std::vector<std::string> fields;
    std::vector<int> materials;
  };
  void add_columns(const std::string& probe, const std::string& field);
  bool watches_stress() const;
  bool any_watches(const char* field) const;

  const SolidBody& body_;
  const SolidFields& derived_;
  std::vector<Watched> probes_;
  std::vector<std::string> columns_;
  std::vector<std::uint8_t> stressed_;
};

/// Von Mises stress of the accepted state with its estimated error.
struct ReportedStress {
  std::string where;  ///< for example "probe 'D'", "largest"
  Vec3 place;         ///< undeformed [m]
  double value;       ///< [Pa]
  double error;       ///< estimated relative error; NaN if unknown
};

/// Position of the largest equivalent stress [m], on all ranks. `points`: point displacements. Collective.
Vec3 place_of_largest_stress(const SolidBody& body, const SolidFields& fields,
                             std::span<const double> points);

/// Stresses at probes and, in static runs, the largest one. The relative error of the tensor is the residual of the
/// recovery (StressRecovery::left_at_points), which stays large where the stress grows with refinement (clamped or
/// reentrant corner). It is NaN in motion, because no patch of cells shows errors that travel. In 81 readings on 14
/// bodies, 81 % are within a factor of 3 of the true error and none below a third (scripts/validate solid-accuracy). On
/// rank 0, else empty. Collective.
std::vector<ReportedStress> reported_stresses(const SolidBody& body, const SolidFields& fields,
                                              const SolidProbes& probes);

}  // namespace couplet::solid
