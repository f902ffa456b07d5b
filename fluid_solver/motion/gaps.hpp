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

/// Parts that closed gaps shut off: those of the fluid that no free cells join to an outlet. What inlets let into
/// such a part has nowhere to go; through the small conductance that blocked faces keep it would be pressed all
/// the same, so it is refused.
template <int D>
class GapPockets {
 public:
  GapPockets(const mesh::Mesh& mesh, const FluidParameters& parameters);
  /// To be called when other cells are blocked than before. `gap`: per local cell, below 0: free. Collective.
  void find(const std::vector<int>& gap);
  /// Throws SchemeFailure, naming the inlets and a place, if the velocities `w` of the boundary faces let a pocket
  /// have more in than out, which a `compressible` fluid can take up, or if they lead into blocked cells. Collective.
  void check(const Placement<D>& at, const Vectors<D>& w, double time, bool compressible) const;

  /// Why a flow may have diverged: a pocket whose walls move; empty if there is none. Collective.
  std::string cause(const Placement<D>& at) const;

 private:
  const mesh::Mesh& mesh_;
  std::vector<const mesh::Patch*> open_,
      given_;                  // given pressure; given velocity but of walls. The same on all ranks
  std::vector<double> label_;  // per local cell: least cell id of its part, plus 1; 0: blocked
  std::vector<double> shut_;   // labels of the parts without an outlet, and 0, ascending
};

/// Gaps that nearly close, a valve on its seat: cells between two walls that are nearer to each other than the
/// given opening are blocked. They move with the mesh like a body, nothing passes them: the free cells beside
/// them see a wall that moves with the mesh, and keep their volume to round-off. What the blocked cells lose in
/// volume until they open again (at most that of the gap at the given opening) is not pressed out. Which cells
/// are blocked follows from the places of the points alone: the same after a restart and in a repeated step.
///
/// The opening at a cell: the distance of its centre from the one wall plus that from the other.
template <int D>
class Gaps final : public Obstacles<D> {
 public:
  using Changed = typename Obstacles<D>::Changed;
  using Obstacles<D>::is_closed;

  /// Throws Error if a gap names what is no patch, or if its seat is elsewhere. `points`: at rest. Collective.
  Gaps(const mesh::Mesh& mesh, const FluidParameters& parameters, std::span<const Vec3> points);

  Changed mark(double t, const std::shared_ptr<const Placement<D>>& at,
               const std::vector<Vec3>& points) override;
  /// Throws SchemeFailure if w presses fluid into a part that is shut off, see GapPockets.
  void begin(const Step<D>& step, const State<D>& from, const Vectors<D>& w) override;
  /// Cells are blocked or freed: an impulse, as in a first step.
  bool starts_anew() const override { return changed_; }
  std::shared_ptr<const std::vector<char>> marks() const override;
  /// Blocked cells move with their centres.
  void hold(const Placement<D>& at, double dt, Vectors<D>& u) const override;
  /// Nothing passes, phi is what the mesh sweeps.
  void block(const Step<D>& step, std::vector<double>& phi) const override;
  using Obstacles<D>::block;
  void correct_memory(State<D>& state) const override;
  bool parts() const override { return active_; }
  void part(const Placement<D>& at, const std::vector<double>& p, const Vectors<D>* gradient,
            const Vectors<D>& area, Vectors<D>& sum) const override;
  std::string cause(const Placement<D>& at) const override;

  const std::vector<std::string>& names() const { return names_; }
  /// State of a gap at the last mark(): least opening at a cell [m] (NaN: everywhere beyond the limit), blocked
  /// cells, their volume [m^3].
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
  std::vector<std::array<const mesh::Patch*, 2>> walls_;  // of each gap
  std::vector<char> never_;                               // per local cell: it has a face of given pressure
  std::vector<int> gap_;  // per local cell the gap that blocks it; below 0: free
  Vectors<D> velocity_;   // per local cell, of blocked ones [m/s]
  std::vector<Facts> facts_;
  bool active_ = false;   // any cell of any rank is blocked
  bool changed_ = false;  // in this step
  std::shared_ptr<const Placement<D>> marked_;
};

}  // namespace couplet::fluid
