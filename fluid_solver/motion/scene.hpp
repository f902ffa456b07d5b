// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/fv/expression.hpp"
#include "common/fv/prescribed_motion.hpp"
#include "common/mesh/periodic_points.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Force on all of the fluid, per mass [m/s^2]. The pressure balances the part of it that is a gradient: the equation solves for
/// p - rho potential, so that no mesh sets a fluid at rest in motion. Boundaries, walls and files use p.
template <int D>
class Force {
 public:
  virtual ~Force() = default;
  /// Called once with the mesh at the start. Collective.
  virtual void start(const Placement<D>&) {}
  /// True if a part of it is no gradient.
  virtual bool acts() const = 0;
  /// Adds the mean of that part over the step from t to t + dt. `u`: velocity at mid-step; empty if no force needs it.
  virtual void add(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
                   Vectors<D>& force) const = 0;
  /// Adds the difference of that part between each boundary face and its cell, if it has one, to `beside`, which may be empty.
  virtual void add_beside_walls(Vectors<D>&) const {}
  /// Returns the potential at time t, a function of the place [m^2/s^2]; empty if no part is a gradient.
  virtual std::function<double(const Vec3&)> potential(double t) const = 0;
  /// Largest rate of the force over the velocity at the two ends of a step [1/s].
  virtual double rate(double, double) const { return 0; }
};

/// Creates the forces of a case. Throws Error for invalid expressions and axes. Collective.
template <int D>
std::vector<std::unique_ptr<Force<D>>> make_forces(const mesh::Mesh& mesh, const Boundary<D>& boundary,
                                                   const FluidParameters& parameters);

/// Frame rotating with omega(t) about an axis through c, in which the mesh and the velocities are described.
/// Forces per mass in it [m/s^2] (Batchelor 1967, (3.2.10)):
///   -2 omega x u  (Coriolis)  - d omega/dt x (x - c)  (Euler)  + grad |omega x (x - c)|^2 / 2  (centrifugal)
/// d omega/dt is the change over the step, so a frame that jumps to its speed accelerates the fluid.
template <int D>
class RotatingFrame final : public Force<D> {
 public:
  /// Throws Error if the speed cannot be parsed or depends on position.
  explicit RotatingFrame(const RotationParameters& parameters);

  bool acts() const override { return true; }
  void add(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
           Vectors<D>& force) const override;
  std::function<double(const Vec3&)> potential(double t) const override;
  /// |2 omega|, the rate of the Coriolis force.
  double rate(double t, double dt) const override;

 private:
  double speed(double t) const { return speed_(Vec3::Zero(), t); }

  fv::Expression speed_;  // [rad/s]
  Vec3 centre_, axis_;
};

/// Integral of (grad u)^T.n over a face [m^2/s] from the velocities of its corners alone: the share of friction on a wall that
/// comes from its motion along itself and its rotation. Where div u = 0, (grad u)^T.n = (n x grad) x u, and by
/// Stokes' theorem its integral is that of dl x u around the face: exact for linear velocities (w x r gives -w x S),
/// and the edges of a closed wall cancel. `corners` [m], `velocities` [m/s]: one after the other around the face, as
/// the mesh has them; in two dimensions the places do not count.
template <int D>
Vec<D> turn_of(std::span<const Vec3> corners, std::span<const Vec3> velocities);

/// Sets `turn` at the faces of a patch from the velocities of their corners. `points`: mesh points.
template <int D>
void set_turn(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> points,
              std::span<const Vec3> velocities, Vectors<D>& turn);

/// Corners of the faces of a patch, in order around each face.
std::vector<Vec3> face_corners(const mesh::Mesh& mesh, const mesh::Patch& patch,
                               std::span<const Vec3> points);

/// Sets w at the faces of a patch to the means of the velocities of their corners, given face by face.
template <int D>
void set_face_means(const mesh::Mesh& mesh, const mesh::Patch& patch, std::span<const Vec3> velocities,
                    Vectors<D>& w);

/// Force on the surroundings by the transposed gradient, -mu T. Loads contains the force by du/dn.
template <int D>
Vec<D> turning_force(double viscosity, const Vec<D>& turn) {
  return -viscosity * turn;
}

/// Sets w [m/s] at body faces to the initial velocity of their motion at `time`, and their turn (see
/// turn_of()) if that is not empty; both per boundary face. Returns the largest speed. Collective.
template <int D>
double set_body_start(const mesh::Mesh& mesh, std::span<const Vec3> points, const Boundary<D>& boundary,
                      const fv::MotionParameters& motion, double time, Vectors<D>& w, Vectors<D>& turn);

/// Parts of the mesh closed to the fluid: immersed bodies or closed gaps. This base class has none. Every
/// function is called a few times per step and itself loops over cells or faces.
template <int D>
class Obstacles {
 public:
  explicit Obstacles(const mesh::Mesh& mesh) : mesh_(mesh), closed_(mesh.cells.n_local(), 0) {}
  virtual ~Obstacles() = default;

  enum class Changed { nothing, shares, cells };  ///< `cells`: the set of closed cells changed
  /// Marks the cells of a placement at time t [s]. The same on all ranks. Collective.
  virtual Changed mark(double, const std::shared_ptr<const Placement<D>>&, const std::vector<Vec3>&) {
    return Changed::nothing;
  }
  /// Prepares a step from a level with the given velocities w [m/s]. Collective.
  virtual void begin(const FluidStep<D>&, const State<D>&, const Vectors<D>&) {}
  /// True if the multi-step schemes restart after this step, which has an impulse.
  virtual bool starts_anew() const { return false; }

  /// True if no face of the cell lets anything pass except the motion of the obstacle.
  bool is_closed(Index cell) const { return closed_[cell] != 0; }
  /// Sets the values of closed cells to zero.
  template <class T>
  void clear(std::vector<T>& values) const {
    if (!any_) return;
    for (std::size_t c = 0; c < values.size(); ++c)
      if (closed_[c]) set_zero(values[c]);
  }
  /// Closed cells of any rank, per local cell; nullptr if they are included in the choice of the step size.
  virtual std::shared_ptr<const std::vector<char>> marks() const { return nullptr; }
  /// Placement for the pressure equation with closed faces nearly blocked; nullptr for that of the step.
  const Placement<D>* around() const { return around_.get(); }

  /// Sets u in and at closed cells. Ghosts are current before and after. Collective.
  virtual void hold(const Placement<D>&, double, Vectors<D>&) const {}
  /// Fluxes of a velocity through the faces as if they were fully open. Collective.
  virtual void carry(const Placement<D>&, const Vectors<D>&, std::vector<double>&) const {}
  /// Reduces these fluxes to the open part of each flux face and adds the motion of the obstacle [m^3/s].
  virtual void block(const FluidStep<D>&, std::vector<double>&) const {}
  /// Does so at boundary faces of given flux.
  virtual void block(const FluidStep<D>&, const std::vector<Index>&, std::vector<double>&) const {}
  /// Corrects the memory of the fluxes of a state, which restarts at closed faces. Collective.
  virtual void correct_memory(State<D>&) const {}

  /// True if the cells inside have their own pressure.
  virtual bool has_pressure() const { return true; }
  /// Adjusts the right-hand side and guess of the pressure equation.
  virtual void before(std::vector<double>& b, std::vector<double>&) const { clear(b); }
  /// Sets the solution in closed cells. Collective.
  virtual void after(const Placement<D>&, std::vector<double>&) const {}
  /// True if part() adds something.
  virtual bool parts() const { return false; }
  /// Adds sign area (p_P - p_f) to `sum` of the free cells at closed faces, p_f linear between the cells
  /// (with `gradient` also on skewed meshes). Such a cell then sees its own pressure there, as at a wall.
  virtual void part(const Placement<D>&, const std::vector<double>&, const Vectors<D>*, const Vectors<D>&,
                    Vectors<D>&) const {}

  /// True if the work of the obstacles is included in the energy budget.
  virtual bool is_in_budget() const { return true; }
  /// Possible cause of a divergent flow; empty if there is none here. Collective.
  virtual std::string cause(const Placement<D>&) const { return {}; }

 protected:
  template <class IsClosed>
  void close(const IsClosed& is_closed) {
    any_ = false;
    for (std::size_t c = 0; c < closed_.size(); ++c) {
      closed_[c] = is_closed(static_cast<Index>(c));
      any_ = any_ || closed_[c];
    }
  }
  const mesh::Mesh& mesh_;
  std::shared_ptr<const Placement<D>> around_;

 private:
  static void set_zero(double& value) { value = 0; }
  static void set_zero(Vec<D>& value) { value.setZero(); }
  std::vector<char> closed_;  // per local cell
  bool any_ = false;          // on this rank
};

/// Everything that stays the same in all steps of a run.
template <int D>
struct Scene {
  const mesh::Mesh& mesh;
  const std::vector<Vec3>& points_at_rest;  ///< as read, per local point [m]
  const Boundary<D>& boundary;
  const FluidParameters& parameters;
  Properties fluid;
  bool oblique = false;  ///< the non-orthogonal parts are needed
  std::vector<std::unique_ptr<Force<D>>> forces{};
  std::unique_ptr<FourthOrder<D>> fourth{};  ///< nullptr means second order everywhere
  /// Each step marks their cells.
  std::unique_ptr<Obstacles<D>> obstacles = std::make_unique<Obstacles<D>>(mesh);

  /// Placement for the pressure equation.
  const Placement<D>& around(const FluidStep<D>& step) const {
    return obstacles->around() ? *obstacles->around() : *step.to;
  }
  const std::vector<Vec3>& points_of(const FluidStep<D>& step) const {
    return step.points.empty() ? points_at_rest : step.points;
  }
  /// Velocity whose face means are the fluxes of u. Collective.
  const Vectors<D>& flux_velocity(const Placement<D>& at, const Vectors<D>& u) const {
    return fourth ? fourth->flux_velocity(at, u) : u;
  }
  bool is_compressible() const { return fluid.sound > 0; }
  /// True if the smooth part of the pressure's excess e enters the flux in advance, see FaceFlux. All of e is remembered where
  /// an obstacle makes it rough, and where waves should travel as on the compact stencil of the pressure, whose dispersion is
  /// a quarter of that of mean velocities. The same on all ranks.
  bool has_smooth_excess() const { return !obstacles->around() && !parameters.is_compressible(); }
  /// Returns the potential of all forces at time t, a function of the place [m^2/s^2]; empty if there is none. The pressure
  /// equation solves for p - rho potential.
  std::function<double(const Vec3&)> potential(double t) const {
    std::vector<std::function<double(const Vec3&)>> parts;
    for (const auto& force : forces)
      if (auto part = force->potential(t)) parts.push_back(std::move(part));
    if (parts.empty()) return {};
    return [parts](const Vec3& x) {
      double sum = 0;
      for (const auto& part : parts) sum += part(x);
      return sum;
    };
  }
  /// Adds `factor` times the potential at the level's time, in the cells and at the boundary.
  void add_potential(const Placement<D>& at, double factor, PressureLevel<D>& level) const {
    const auto psi = potential(level.time);
    if (!psi) return;
    Vec3 x = Vec3::Zero();
    for (std::size_t c = 0; c < level.p.size(); ++c) {
      x.template head<D>() = at.centre[c];
      level.p[c] += factor * psi(x);
    }
    for (std::size_t b = 0; b < level.boundary.size(); ++b)
      level.boundary[b] += factor * psi(at.boundary_centre[b]);
  }
};

/// Positions of the mesh within a coupling step. Points move on straight lines from level n to the end.
template <int D>
class MeshPath {
 public:
  /// `geometry`: geometry of the mesh at rest; only its points are kept. `moves`: true if the mesh will move. Collective.
  MeshPath(const mesh::Mesh& mesh, const mesh::Geometry& geometry, const FluidParameters& parameters,
           bool moves);

  /// Points as read, per local point [m].
  const std::vector<Vec3>& points_at_rest() const { return points_at_rest_; }

  bool moves() const { return moves_; }
  /// True if the mesh only moves as a translating frame.
  bool translates() const { return translates_; }
  /// Placement of the mesh at rest. A translated frame keeps the pressure equation and its factors.
  std::shared_ptr<const Placement<D>> start(const mesh::Geometry& geometry);
  /// Placement of other points; of the points at rest if `points` is empty.
  std::shared_ptr<const Placement<D>> at(std::span<const Vec3> points) const;
  /// Sub-step of `dt` on a mesh that ends at the share `s` of the way from `begin` to `end` (empty if it is
  /// at rest there). `level`: start, at t = `time` of the coupling step. Throws SolveFailure for inverted
  /// cells. Collective.
  SubStep<D> sub_step(const State<D>& level, double dt, double s, std::span<const Vec3> begin,
                      std::span<const Vec3> end, double time) const;
  /// Throws Error if the points at `time` separate joined patches. Collective.
  void refuse_torn(std::span<const Vec3> points, double time) const;

 private:
  const mesh::Mesh& mesh_;
  const std::vector<Vec3> points_at_rest_;
  bool moves_, translates_;
  std::optional<mesh::PeriodicPoints> periodic_;  // for joined patches on a moving mesh
  std::shared_ptr<const Placement<D>> frame_;     // placement at rest, for a translating frame
};

}  // namespace couplet::fluid
