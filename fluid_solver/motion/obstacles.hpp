// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/types.hpp"
#include "common/fv/expression.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Parts of the fluid that closed gaps cut off from every outlet. Inflow into such a part has nowhere to go.
/// The small conductance of blocked faces would still let it through, so it is rejected.
template <int D>
class GapPockets {
 public:
  GapPockets(const mesh::Mesh& mesh, const FluidParameters& parameters);
  /// Call when the set of blocked cells has changed. `gap`: per local cell, negative if free. Collective.
  void find(const std::vector<int>& gap);
  /// Throws SchemeFailure, with the inlets and a place, if the boundary velocities `w` have a net inflow into
  /// a pocket or lead into blocked cells. A `compressible` fluid can take up a net inflow. Collective.
  void check(const Placement<D>& at, const Vectors<D>& w, double time, bool compressible) const;

  /// Possible cause of a divergent flow: a pocket with moving walls; empty if there is none. Collective.
  std::string cause(const Placement<D>& at) const;

 private:
  const mesh::Mesh& mesh_;
  // Patches of given pressure, and of given velocity except walls; equal on all ranks.
  std::vector<const mesh::Patch*> open_, given_;
  std::vector<double> label_;  // per local cell: lowest cell id of its part, plus 1; 0 if blocked
  std::vector<double> shut_;   // labels of the parts without an outlet, and 0, in ascending order
};

/// Gaps that almost close, such as a valve on its seat. Cells are blocked if their two walls are closer than
/// the given opening. Blocked cells move with the mesh like a body and let nothing pass. The adjacent free
/// cells see a wall that moves with the mesh, and keep their volume to round-off. Volume lost by blocked
/// cells until they reopen, at most that of the gap at the given opening, is not displaced. Only the
/// positions of the points determine which cells are blocked, so restarts and repeated steps agree. The
/// opening at a cell is the sum of the distances of its center from both walls.
template <int D>
class Gaps final : public Obstacles<D> {
 public:
  using Changed = typename Obstacles<D>::Changed;
  using Obstacles<D>::is_closed;

  /// Throws Error if a gap names a missing patch or its seat is elsewhere. `points`: at rest. Collective.
  Gaps(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points);

  Changed mark(double t, const std::shared_ptr<const Placement<D>>& at,
               const std::vector<Vec3>& points) override;
  /// Throws SchemeFailure if w forces fluid into a part that is cut off, see GapPockets.
  void begin(const FluidStep<D>& step, const State<D>& from, const Vectors<D>& w) override;
  /// True if cells were blocked or freed, which gives an impulse as in a first step.
  bool starts_anew() const override { return changed_; }
  std::shared_ptr<const std::vector<char>> marks() const override;
  /// Moves blocked cells with their centers.
  void hold(const Placement<D>& at, double dt, Vectors<D>& u) const override;
  /// Sets phi of blocked faces to the volume swept by the mesh.
  void block(const FluidStep<D>& step, std::vector<double>& phi) const override;
  using Obstacles<D>::block;
  void correct_memory(State<D>& state) const override;
  bool parts() const override { return active_; }
  void part(const Placement<D>& at, const std::vector<double>& p, const Vectors<D>* gradient,
            const Vectors<D>& area, Vectors<D>& sum) const override;
  std::string cause(const Placement<D>& at) const override;

  const std::vector<std::string>& names() const { return names_; }
  /// State of a gap at the last mark(): smallest opening at a cell [m] (NaN if all exceed the limit), number
  /// of blocked cells and their volume [m^3].
  struct GapState {
    double opening = 0, cells = 0, volume = 0;
  };
  const std::vector<GapState>& facts() const { return facts_; }

 private:
  using Obstacles<D>::mesh_;
  using Obstacles<D>::around_;
  bool is_blocked(Index f) const { return is_closed(mesh_.owner[f]) || is_closed(mesh_.neighbour[f]); }
  void mark_gap(int gap, std::span<const Vec3> points, const Placement<D>& at);

  GapPockets<D> pockets_;
  bool compressible_;
  std::vector<std::string> names_;
  std::vector<double> limit_;                             // opening [m]
  std::vector<std::array<const mesh::Patch*, 2>> walls_;  // per gap
  std::vector<char> never_;                               // per local cell: it has a face of given pressure
  std::vector<int> gap_;  // per local cell the gap that blocks it; negative if free
  Vectors<D> velocity_;   // per local cell, of blocked cells [m/s]
  std::vector<GapState> facts_;
  bool active_ = false;   // a cell of any rank is blocked
  bool changed_ = false;  // in this step
  std::shared_ptr<const Placement<D>> marked_;
};

/// Share of a segment, triangle or tetrahedron where a level is positive, and the integral of the level there
/// over the size of the whole.
struct OpenPart {
  double share = 0, moment = 0;
};

/// Corner of a simplex and the level there.
struct LevelCorner {
  Vec3 place = Vec3::Zero();
  double level = 0;
};

using Level = std::function<double(const Vec3&)>;

/// Locates the zeros of the level itself on the edges, so that a surface edge or corner on an edge is
/// captured exactly. Between edges the surface is flat. `corners`: two, three or four. Levels up to
/// `round_off` count as zero.
OpenPart open_part(std::span<const LevelCorner> corners, const Level& level, double round_off);

/// Level [m] at the points and cells of a mesh, and at arbitrary places.
struct LevelField {
  std::span<const Vec3> points;  ///< per local point
  std::span<const double> at_points, at_centres;
  Level anywhere;
};

/// Cut of the mesh with the surface of bodies, where a level is zero, see open_part(). It varies continuously
/// with surface and mesh and is exact for planes. No face of a closed cell is open.
template <int D>
struct CutCells {
  std::vector<double> faces;       ///< open share, per flux face
  std::vector<double> cells;       ///< open share, per local cell
  std::vector<double> open_depth;  ///< mean level of the open part, per local cell [m]; 0 if none is open
  /// Largest difference of the level from that at the center, per local cell [m].
  std::vector<double> extent;
  Vectors<D> wall;  ///< area vector of the surface in the cell, out of the open part, per local cell [m^2]
};

/// Collective.
template <int D>
CutCells<D> cut(const mesh::Mesh& mesh, const Placement<D>& at, const LevelField& levels);

/// Rigid bodies inside the mesh by direct forcing. Cells with their center in a body have its velocity. In
/// the layer of them next to the fluid, the velocity is set so that it matches the body where the level is
/// zero, on a line to a fluid cell. The open share of a face scales its flux and the coupling of the two
/// pressures. With `surface: steps` it is 0 or 1 by the marked cells. With `cut` it is the part outside the
/// bodies, so that cells open and close gradually. Mesh and bodies may both move. Everything follows from
/// time and points, so restarts and repeats agree.
template <int D>
class ImmersedBodies final : public Obstacles<D> {
 public:
  using Changed = typename Obstacles<D>::Changed;
  using Obstacles<D>::is_closed;

  /// `parameters`: must have the same kind of surface for all bodies.
  ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters);

  Changed mark(double t, const std::shared_ptr<const Placement<D>>& at,
               const std::vector<Vec3>& points) override;
  /// True if the cell's center was in a body at the last mark().
  bool is_solid(Index cell) const { return body_[cell] >= 0; }
  /// Share of a flux face through which the fluid passes.
  double open(Index f) const { return cut_ ? shape_.faces[f] : blocked(f) ? 0 : 1; }
  bool cuts() const { return cut_; }
  /// True if a cell at the flux face is cut or closed; `cut` only.
  bool beside_surface(Index f) const {
    return shape_.cells[mesh_.owner[f]] < 1 || shape_.cells[other(f)] < 1;
  }
  /// Volume flux of the bodies' motion through the closed part of a face [m^3/s].
  double carried(Index flux_face, const Placement<D>& at) const;
  /// Sets u in the marked cells; at a cut surface u approaches that value within `dt`.
  void hold(const Placement<D>& at, double dt, Vectors<D>& u) const override;
  /// Adjusts mean fluxes of whole faces at the surface to the velocity of the open cell parts; `cut` only.
  void carry(const Placement<D>& at, const Vectors<D>& u, std::vector<double>& phi) const override;
  void block(const FluidStep<D>& step, std::vector<double>& phi) const override;
  void block(const FluidStep<D>& step, const std::vector<Index>& boundary_faces,
             std::vector<double>& phi) const override;
  void correct_memory(State<D>& state) const override;
  bool has_pressure() const override { return false; }
  void before(std::vector<double>& b, std::vector<double>& p) const override;
  /// Takes the mean of adjacent fluid cells in a closed cell, so that the gradient there has no jump.
  void after(const Placement<D>& at, std::vector<double>& p) const override;
  bool is_in_budget() const override { return false; }

  /// Forces on each body [N]: pressure, then friction. `p` must include its gradient. Collective.
  std::vector<std::pair<Vec<D>, Vec<D>>> forces(const Placement<D>& at, const PressureLevel<D>& level,
                                                const Vectors<D>& u, double viscosity) const;
  const std::vector<std::string>& names() const { return names_; }
  /// Sum of |phi - flux displaced by the body| over closed faces between body and fluid [m^3/s]. Collective.
  double leak(const Placement<D>& at, const std::vector<double>& phi) const;

 private:
  using Obstacles<D>::mesh_;
  using Obstacles<D>::around_;
  using Sums = std::vector<double>;  // per body: pressure, then friction
  Index other(Index f) const { return f < mesh_.n_interior ? mesh_.neighbour[f] : mesh_.owner[f]; }
  bool blocked(Index f) const { return is_solid(mesh_.owner[f]) || is_solid(other(f)); }
  Changed mark_cells(double t, const Placement<D>& at, std::span<const Vec3> points);
  void note_use() const;
  void find_levels(double t, const Placement<D>& at);
  void find_velocities(double t, const Placement<D>& at);
  CutCells<D> shape(double t, const Placement<D>& at, std::span<const Vec3> points) const;
  void force_by_steps(const Placement<D>& at, Vectors<D>& u) const;
  void force_by_cuts(const Placement<D>& at, double dt, Vectors<D>& u) const;
  Vectors<D> slopes(const Placement<D>& at, const Vectors<D>& u) const;
  void add_forces_of_steps(const Placement<D>& at, const std::vector<double>& p, const Vectors<D>& u,
                           double viscosity, Sums& sums) const;
  void add_forces_of_cuts(const Placement<D>& at, const PressureLevel<D>& level, const Vectors<D>& u,
                          double viscosity, Sums& sums) const;
  std::shared_ptr<const Placement<D>> around_of_;  // from which around_ was made
  bool cut_;
  double nu_;  // [m^2/s]
  std::vector<std::string> names_;
  std::vector<fv::Expression> level_;
  std::vector<std::vector<fv::Expression>> speed_;
  std::vector<int> body_;      // per local cell; -1 in the fluid
  std::vector<double> depth_;  // per local cell: lowest level of all bodies [m]
  Vectors<D> velocity_;        // per local cell, of its body
  std::vector<Index> faces_;   // interior faces between body and fluid
  std::vector<int> nearest_;   // per local cell: body with the lowest level; `cut` only
  CutCells<D> shape_;          // `cut` only
};

/// Creates the obstacles of a case. Collective.
template <int D>
std::unique_ptr<Obstacles<D>> make_obstacles(const mesh::Mesh& mesh, const FluidParameters& parameters,
                                             std::span<const Vec3> points_at_rest);

/// Resolves `surface: auto` of bodies. Throws Error if two bodies differ.
FluidParameters with_surfaces(FluidParameters parameters, bool moving);

}  // namespace couplet::fluid
