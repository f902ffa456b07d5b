// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <string>
#include <vector>

#include "common/base/types.hpp"

namespace couplet::io {
class CheckpointWriter;
class CheckpointReader;
}  // namespace couplet::io

namespace couplet::coupling {

enum class Scheme : int { standalone, explicit_, semi_implicit, implicit };

/// Interface of a participant: its vertices, faces and data. Each rank has the vertices and faces it owns
/// (see InterfaceMap). A small participant may keep all of them on rank 0. In 2-D, z = 0 without a duplicate
/// layer.
struct Interface {
  enum class Place : int { vertices, faces };
  struct Datum {
    std::string name;  ///< "displacement", "velocity", "pressure-force", "viscous-force", ...
    std::string unit;
    Place place = Place::vertices;
    int components = 0;  ///< values per location; 0 means one per dimension (a vector)
    int size(int dim) const { return components > 0 ? components : dim; }
  };
  int dim = 3;
  std::vector<Vec3> vertices;      ///< reference configuration [m]
  std::vector<Vec3> face_centres;  ///< reference configuration [m]
  std::vector<Vec3> face_areas;    ///< out of this participant [m^2]
  std::vector<Datum> takes, gives;
  /// Corners of face f in cyclic order, as positions in the concatenated vertex lists of all ranks:
  /// face_vertices[face_offset[f]] .. [face_offset[f + 1] - 1]. Both are empty if unknown.
  std::vector<Index> face_offset{}, face_vertices{};
  /// Numbers that do not depend on the partition. If empty, the position is the number.
  std::vector<GlobalIndex> vertex_ids{}, face_ids{};
  bool empty() const { return vertices.empty() && face_centres.empty(); }
};

/// Returns true for forces and heats, whose sums are conserved by the mapping. They are means over a step;
/// other data are taken at its end.
inline bool is_amount(const Interface::Datum& datum) { return datum.unit == "N" || datum.unit == "W"; }

/// Interface values by name for the entries that this rank owns, with the datum's number of components each.
/// A rank without entries has no such name.
///
///   displacement  vertices  t^{n+1}, relative to the reference configuration [m]
///   velocity      vertices  t^{n+1}, of the structure [m/s]
///   pressure-force, viscous-force  faces  mean over the step (t^{n+1/2}), on the receiver [N]; 2-D: per meter
using Exchange = std::map<std::string, std::vector<double>>;

struct Step {
  double time = 0;  ///< t^n
  double dt = 0;
  Scheme scheme = Scheme::standalone;
  GlobalIndex number = 0;
  int sub_steps = 1;     ///< number of steps of the participant within this coupling step (see SubStepping)
  bool is_last = false;  ///< once accepted, it ends the run; false in a coupled job
};

/// Summary of an accepted step for guards, studies and monitors, the same for all participants. A number is
/// NaN if it was not computed anyway.
struct StepReport {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double dt = 0;            ///< [s]
  long iterations = 0;      ///< of linear solvers in the accepted solve()
  double error = unknown;   ///< estimated time error of the step, relative to the size of the solution [1]
  double energy = unknown;  ///< of the accepted state [J]
  double change = unknown;  ///< see Participant::change()
  /// Since the last accepted step, failed attempts included; filled in by who drives the run.
  double seconds = 0;
};

/// Interface of a physics program. All calls are collective over its ranks.
///
/// Contract, which tests/contract checks for every implementation: solve() starts from the accepted state n,
/// so equal input gives equal output to solver tolerance. Warm starts are allowed. A fluid in a semi-implicit
/// step may answer differently after it renews its prediction with the velocity of a pass. Only accept_step()
/// changes state n. begin_step() may be called again with another dt without accept_step(). load(save())
/// continues bit for bit on the same number of ranks. A step that cannot be solved throws SolveFailure on
/// every rank and keeps state n.
class Participant {
 public:
  virtual ~Participant() = default;
  virtual Interface initialise() = 0;
  /// Largest time step that this participant recommends now [s], or infinity.
  virtual double suggest_dt() { return std::numeric_limits<double>::infinity(); }
  virtual void begin_step(const Step& step) = 0;
  virtual Exchange solve(const Exchange& in) = 0;
  /// Returns true if the last solve() renewed a prediction, so that differences to earlier passes of this
  /// step are no longer comparable.
  virtual bool renewed_prediction() const { return false; }
  /// Accepts the step. Must not fail: everything that can fail belongs in solve().
  virtual StepReport accept_step() = 0;
  /// Change of the solution in the last accepted step relative to its size [1]; NaN if it has no answer. Called only in runs that
  /// look for a steady state. Collective.
  virtual double change() const { return StepReport::unknown; }
  virtual void save(io::CheckpointWriter& file) const = 0;
  virtual void load(io::CheckpointReader& file) = 0;
  /// Writes fields at this accepted time when output is due. `number` counts outputs from 0.
  virtual void write_output(double time, int number) = 0;
  /// Writes monitors and probes after each accepted step.
  virtual void write_monitors(double time) = 0;
  /// Called once after the last step: writes remaining output and returns closing sentences, which rank 0
  /// prints. Collective.
  virtual std::vector<std::string> finish() { return {}; }
};

}  // namespace couplet::coupling
