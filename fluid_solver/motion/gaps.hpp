// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/parameters/parameters.hpp"

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
  void begin(const Step<D>& step, const State<D>& from, const Vectors<D>& w) override;
  /// True if cells were blocked or freed, which gives an impulse as in a first step.
  bool starts_anew() const override { return changed_; }
  std::shared_ptr<const std::vector<char>> marks() const override;
  /// Moves blocked cells with their centers.
  void hold(const Placement<D>& at, double dt, Vectors<D>& u) const override;
  /// Sets phi of blocked faces to the volume swept by the mesh.
  void block(const Step<D>& step, std::vector<double>& phi) const override;
  using Obstacles<D>::block;
  void correct_memory(State<D>& state) const override;
  bool parts() const override { return active_; }
  void part(const Placement<D>& at, const std::vector<double>& p, const Vectors<D>* gradient,
            const Vectors<D>& area, Vectors<D>& sum) const override;
  std::string cause(const Placement<D>& at) const override;

  const std::vector<std::string>& names() const { return names_; }
  /// State of a gap at the last mark(): smallest opening at a cell [m] (NaN if all exceed the limit), number
  /// of blocked cells and their volume [m^3].
  struct Facts {
    double opening = 0, cells = 0, volume = 0;
  };
  const std::vector<Facts>& facts() const { return facts_; }

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
  std::vector<Facts> facts_;
  bool active_ = false;   // a cell of any rank is blocked
  bool changed_ = false;  // in this step
  std::shared_ptr<const Placement<D>> marked_;
};

}  // namespace couplet::fluid
