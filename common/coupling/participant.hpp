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

/// What a participant shows of itself at its interface: each of its ranks has the vertices and faces that it
/// owns, each once (see InterfaceMap); a small participant may leave all of them to its rank 0. 2-D: z = 0,
/// no duplicate layer.
struct Interface {
  enum class Place : int { vertices, faces };
  struct Datum {
    std::string name;  ///< "displacement", "velocity", "pressure-force", "viscous-force", ...
    std::string unit;
    Place place = Place::vertices;
    int components = 0;  ///< values a place; 0: one a dimension (a vector)
    int size(int dim) const { return components > 0 ? components : dim; }
  };
  int dim = 3;
  std::vector<Vec3> vertices;      ///< reference configuration [m]
  std::vector<Vec3> face_centres;  ///< reference configuration [m]
  std::vector<Vec3> face_areas;    ///< out of this participant [m^2]
  std::vector<Datum> takes, gives;
  /// Corners of face f, in their order around it, as positions in the list of all ranks' vertices, rank by
  /// rank: face_vertices[face_offset[f]] .. [face_offset[f + 1] - 1]. Both empty if they are not known.
  std::vector<Index> face_offset{}, face_vertices{};
  /// Numbers that do not depend on how the mesh is cut over ranks. Empty: the position is the number.
  std::vector<GlobalIndex> vertex_ids{}, face_ids{};
  /// Names of its parts (patches), and of which part each face is. May be empty.
  std::vector<std::string> parts{};
  std::vector<int> face_part{};
  bool empty() const { return vertices.empty() && face_centres.empty(); }
};

/// Whether sums of it are kept when it is carried over: forces and heats. They are means over a step, all
/// else is taken at its end.
inline bool is_amount(const Interface::Datum& datum) { return datum.unit == "N" || datum.unit == "W"; }

/// Interface values by name: entries x dim (or the datum's own number of components), entry by entry, of the
/// entries that this rank owns; a rank that owns none has no such name.
///   displacement  vertices  t^{n+1}, relative to the reference configuration [m]
///   velocity      vertices  t^{n+1}, the structure's own [m/s]
///   pressure-force, viscous-force  faces  mean over the step (t^{n+1/2}), acting on the receiver [N] (per
///   metre depth in 2-D)
using Exchange = std::map<std::string, std::vector<double>>;

struct Step {
  double time = 0;  ///< t^n
  double dt = 0;
  Scheme scheme = Scheme::standalone;
  GlobalIndex number = 0;
  int sub_steps = 1;     ///< that the participant takes within this coupling step (see SubStepping)
  bool waveform = true;  ///< they see their input as a line in time; false: as constant
  bool is_last = false;  ///< accepted, it ends the run; false in a coupled job
};

/// What an accepted step was like: what guards, studies and monitors read, of every participant alike. A
/// number that was not computed is NaN; none is computed for the report's sake alone.
struct StepReport {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double dt = 0;            ///< [s]
  long iterations = 0;      ///< of linear solvers in the solve() that was accepted
  double error = unknown;   ///< estimated time error of the step, over the size of the solution [1]
  double energy = unknown;  ///< of the accepted state [J]
  /// Since the last accepted step, failed attempts included; filled in by who drives the run.
  double seconds = 0;
};

/// A physics program seen from outside. All calls are collective over its ranks.
///
/// Contract (tests/contract holds every implementation to it): solve() starts from the accepted state n, so
/// equal input gives equal output to solver tolerance (warm starts are fine; a fluid in a semi-implicit step
/// may answer otherwise whenever it renews its prediction with the velocity of a pass, and stays with
/// that); only accept_step() changes state n; begin_step() may be called again with another dt without
/// accept_step() in between; load(save()) continues bit for bit on equal ranks. A step that cannot be solved
/// throws SolveFailure on every rank and leaves state n as it was.
class Participant {
 public:
  virtual ~Participant() = default;
  virtual Interface initialise() = 0;
  /// Largest step this participant advises now [s]; infinity if it has no wish.
  virtual double suggest_dt() { return std::numeric_limits<double>::infinity(); }
  virtual void begin_step(const Step& step) = 0;
  virtual Exchange solve(const Exchange& in) = 0;
  /// Whether the last solve() has begun to answer otherwise than those before it in this step (a prediction that
  /// was renewed): what was learnt from differences to them holds no more.
  virtual bool answered_anew() const { return false; }
  /// Cannot fail: what can, fails in solve().
  virtual StepReport accept_step() = 0;
  virtual void save(io::CheckpointWriter& file) const = 0;
  virtual void load(io::CheckpointReader& file) = 0;
  /// Writes fields for this accepted time (called when output is due). `number` counts outputs from 0.
  virtual void write_output(double time, int number) = 0;
  /// Monitors and probes after each accepted step.
  virtual void write_monitors(double time) = 0;
  /// Called once after the last step: writes what is due then, and gives closing sentences, which
  /// rank 0 prints. Collective.
  virtual std::vector<std::string> finish() { return {}; }
};

}  // namespace couplet::coupling
