// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Gaps that nearly close, a valve on its seat: cells between two walls that are nearer to each other than the
/// given opening are blocked. They move with the mesh like a body, nothing passes them: the free cells beside
/// them see a wall that moves with the mesh, and keep their volume to round-off. What the blocked cells lose in
/// volume until they open again (at most that of the gap at the given opening) is not pressed out. Which cells
/// are blocked follows from the places of the points alone: the same after a restart and in a repeated step.
///
/// The opening at a cell: the distance of its centre from the one wall plus that from the other.
template <int D>
class Gaps {
 public:
  /// Throws Error if a gap names what is no patch, or less than two.
  Gaps(const mesh::Mesh& mesh, const FluidParameters& parameters);

  /// Marks the cells of a placement. Gives whether any mark changed on any rank. Collective.
  bool mark(std::span<const Vec3> points, const Placement<D>& at);
  /// The velocity of blocked cells in a step: that of their centres. `dt` 0: at rest.
  void follow(const Placement<D>& from, const Placement<D>& to, double dt);
  /// Gives the blocked cells that velocity.
  void hold(Vectors<D>& u) const;
  bool active() const { return active_; }  ///< any cell of any rank is blocked
  /// Per local cell the gap that blocks it, below 0: free.
  const std::vector<int>& blocked_by() const { return gap_; }
  bool is_blocked(Index cell) const { return gap_[cell] >= 0; }
  bool blocked(Index f) const { return is_blocked(mesh_.owner[f]) || is_blocked(mesh_.neighbour[f]); }
  const std::vector<std::string>& names() const { return names_; }
  /// Of each gap at the last mark(): least opening at a cell [m] (NaN: everywhere beyond the limit), blocked
  /// cells, their volume [m^3].
  struct Facts {
    double opening = 0, cells = 0, volume = 0;
  };
  const std::vector<Facts>& facts() const { return facts_; }
  /// Of the blocked cells as they are now, per local cell, for StepSize; null where none is.
  std::shared_ptr<const std::vector<char>> marks() const;
  /// From those of another level (null: none blocked)? Collective.
  bool differs(const std::vector<char>* marks) const;

 private:
  struct Wall {
    std::vector<const mesh::Patch*> patches;
    std::vector<double> corners(const mesh::Mesh& mesh, std::span<const Vec3> points, const Vec3& low,
                                const Vec3& high) const;
    void extend(const mesh::Mesh& mesh, std::span<const Vec3> points, Vec3& low, Vec3& high) const;
  };
  void mark_gap(int gap, std::span<const Vec3> points, const Placement<D>& at);

  const mesh::Mesh& mesh_;
  std::vector<std::string> names_;
  std::vector<double> limit_;               // opening [m]
  std::vector<std::array<Wall, 2>> walls_;  // of each gap
  std::vector<char> never_;                 // per local cell: it has a face of given pressure
  std::vector<int> gap_;                    // per local cell
  Vectors<D> velocity_;                     // per local cell, of blocked ones [m/s]
  std::vector<Facts> facts_;
  bool active_ = false;
};

}  // namespace couplet::fluid
