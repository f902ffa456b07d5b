// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/fv/expression.hpp"
#include "fluid_solver/motion/cut_cells.hpp"
#include "fluid_solver/motion/obstacles.hpp"
#include "fluid_solver/parameters/parameters.hpp"

namespace couplet::fluid {

/// Rigid bodies inside the mesh (direct forcing): the cells whose centre lies in a body carry its velocity, and the velocity in
/// the layer of them next to the fluid is set so that on the straight line to a fluid cell it passes through the body's
/// velocity where the level is zero. What passes a face and what couples two pressures is the face's open share: with
/// `surface: steps` nothing or all, by the marked cells; with `cut` what of the face lies outside of the bodies, so that cells
/// which pass the surface close and open gradually. Mesh and bodies may both move. All follows from time and points alone: it is
/// the same after a restart and in a repeated step.
template <int D>
class ImmersedBodies final : public Obstacles<D> {
 public:
  using Changed = typename Obstacles<D>::Changed;
  using Obstacles<D>::is_closed;

  /// `parameters`: with the same kind of surface for all bodies.
  ImmersedBodies(const mesh::Mesh& mesh, const FluidParameters& parameters);

  Changed mark(double t, const std::shared_ptr<const Placement<D>>& at,
               const std::vector<Vec3>& points) override;
  /// Its centre is in a body since the last mark().
  bool is_solid(Index cell) const { return body_[cell] >= 0; }
  /// Share of a flux face through which the fluid passes.
  double open(Index f) const { return cut_ ? shape_.faces[f] : blocked(f) ? 0 : 1; }
  bool cuts() const { return cut_; }
  /// One of the cells at a flux face is cut or closed; `cut` only.
  bool beside_surface(Index f) const {
    return shape_.cells[mesh_.owner[f]] < 1 || shape_.cells[other(f)] < 1;
  }
  /// Volume flux of the bodies' motion through what of a face is not open [m^3/s].
  double carried(Index flux_face, const Placement<D>& at) const;
  /// In the marked cells; beside a surface that cuts cells u goes over to that within `dt`.
  void hold(const Placement<D>& at, double dt, Vectors<D>& u) const override;
  /// Mean fluxes of whole faces beside the surface with the velocity in the middle of what is open of the cells; `cut` only.
  void carry(const Placement<D>& at, const Vectors<D>& u, std::vector<double>& phi) const override;
  void block(const Step<D>& step, std::vector<double>& phi) const override;
  void block(const Step<D>& step, const std::vector<Index>& boundary_faces,
             std::vector<double>& phi) const override;
  void correct_memory(State<D>& state) const override;
  bool has_pressure() const override { return false; }
  void before(std::vector<double>& b, std::vector<double>& p) const override;
  /// Mean of the fluid cells beside a closed one, so that the gradient there sees no jump.
  void after(const Placement<D>& at, std::vector<double>& p) const override;
  bool is_in_budget() const override { return false; }

  /// On each body [N]: pressure, then friction. `p` with its gradient. Collective.
  std::vector<std::pair<Vec<D>, Vec<D>>> forces(const Placement<D>& at, const PressureLevel<D>& level,
                                                const Vectors<D>& u, double viscosity) const;
  const std::vector<std::string>& names() const { return names_; }
  /// Sum of |phi - what the body displaces| over the closed faces between body and fluid [m^3/s]. Collective.
  double leak(const Placement<D>& at, const std::vector<double>& phi) const;

 private:
  using Obstacles<D>::mesh_;
  using Obstacles<D>::around_;
  using Sums = std::vector<double>;  // of each body: pressure, then friction
  Index other(Index f) const { return f < mesh_.n_interior ? mesh_.neighbour[f] : mesh_.owner[f]; }
  bool blocked(Index f) const { return is_solid(mesh_.owner[f]) || is_solid(other(f)); }
  Changed mark_cells(double t, const Placement<D>& at, std::span<const Vec3> points);
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
  std::shared_ptr<const Placement<D>> around_of_;  // that around_ was made from
  bool cut_;
  double nu_;  // [m^2/s]
  std::vector<std::string> names_;
  std::vector<fv::Expression> level_;
  std::vector<std::vector<fv::Expression>> speed_;
  std::vector<int> body_;      // per local cell; -1: fluid
  std::vector<double> depth_;  // per local cell: lowest level of all bodies [m]
  Vectors<D> velocity_;        // per local cell, of its body
  std::vector<Index> faces_;   // interior faces between body and fluid
  std::vector<int> nearest_;   // per local cell: the body of the lowest level; `cut` only
  CutCells<D> shape_;          // `cut` only
};

}  // namespace couplet::fluid
