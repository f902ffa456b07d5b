// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fluid_solver/motion/gap_pockets.hpp"
#include "fluid_solver/motion/obstacles.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

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
  using Obstacles<D>::is_closed;
  struct Wall {
    std::vector<const mesh::Patch*> patches;
    std::vector<double> corners(const mesh::Mesh& mesh, std::span<const Vec3> points, const Vec3& low,
                                const Vec3& high) const;
    void extend(const mesh::Mesh& mesh, std::span<const Vec3> points, Vec3& low, Vec3& high) const;
  };
  bool is_blocked(Index f) const { return is_closed(mesh_.owner[f]) || is_closed(mesh_.neighbour[f]); }
  void mark_gap(int gap, std::span<const Vec3> points, const Placement<D>& at);

  GapPockets<D> pockets_;
  bool compressible_;
  std::vector<std::string> names_;
  std::vector<double> limit_;               // opening [m]
  std::vector<std::array<Wall, 2>> walls_;  // of each gap
  std::vector<char> never_;                 // per local cell: it has a face of given pressure
  std::vector<int> gap_;                    // per local cell the gap that blocks it; below 0: free
  Vectors<D> velocity_;                     // per local cell, of blocked ones [m/s]
  std::vector<Facts> facts_;
  bool active_ = false;   // any cell of any rank is blocked
  bool changed_ = false;  // in this step
  std::shared_ptr<const Placement<D>> marked_;
};

}  // namespace couplet::fluid
