// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "common/fv/expression.hpp"
#include "common/linalg/acceleration.hpp"
#include "common/linalg/krylov.hpp"
#include "fluid_solver/boundary/boundary.hpp"
#include "fluid_solver/momentum/rates.hpp"
#include "fluid_solver/motion/scene.hpp"
#include "fluid_solver/parameters/parameters.hpp"
#include "fluid_solver/state/state.hpp"

namespace couplet::fluid {

/// Exchange of heat with the surroundings, k dT/dn = h (T_a - T_b) + q at each boundary face with T less the reference temperature.
/// All conditions are cases of it: h is infinite where T_b is given, and 0 where the flux is.
struct HeatExchange {
  std::vector<double> coefficient;  ///< h [W/(m^2 K)]
  std::vector<double> ambient;      ///< T_a [K]
  std::vector<double> flux;         ///< q into the fluid [W/m^2]
};

/// Evaluates the thermal conditions that the case gives to its patches.
template <int D>
class HeatBoundary {
 public:
  HeatBoundary(const mesh::Mesh& mesh, const FluidParameters& parameters);
  /// Sets the exchange at time t [s]. `through`: volume flux out of the fluid per flux face [m^3/s], which tells where fluid
  /// enters through an outlet.
  void set(double t, const Placement<D>& at, std::span<const double> through, HeatExchange& exchange) const;
  /// Sets the temperature at the faces of outlets that have one of their own: that where fluid enters at time t, else that of
  /// the cell. `temperature` per local cell, `boundary` per boundary face [K].
  void set_outlets(double t, const Placement<D>& at, std::span<const double> through,
                   std::span<const double> temperature, std::span<double> boundary) const;

 private:
  struct GivenHeat {
    FaceRange faces;
    fv::Expression coefficient{}, ambient{}, flux{};
    bool is_temperature = false;  // ambient is the temperature of the face
    bool only_where_it_enters = false;
  };
  const mesh::Mesh& mesh_;
  std::vector<GivenHeat> patches_;
  double reference_;  // [K]
};

/// Heat carried by the volume fluxes of the flow and conducted, with a = k/(rho c),
///   d(V T)/dt = sum_f [-(phi - dV_f/dt) T_f + a (grad T)_f . S].
/// It is second order in space and time on moving meshes, conserves the sum of V T to round-off, and keeps a uniform T where the
/// fluxes of each cell sum to zero. Convection is treated as that of the velocity: T_f is the mean of the cells, and the
/// product phi T_f is extrapolated to the middle of the step. Conduction always has the weights of implicit friction, 9/16, 3/8
/// and 1/16 at equal steps. The temperature of a step does not depend on the pressure and is computed first. Where the flow takes steps
/// beyond a Courant number of 1 or is frozen, convection has these weights, too, with phi extrapolated to t^{n+1}.
template <int D>
class HeatTransport {
 public:
  HeatTransport(const Scene<D>& scene, const FluidStep<D>& step);

  /// Sets the initial temperature of a state with its mesh and fluxes. Collective.
  void start(State<D>& state);
  /// Computes T^{n+1} from a level. May be called again from the same level. Collective.
  void advance(const State<D>& from);
  /// Starts a step of a coupling, of any number of sub-steps, of `duration` [s] from a level.
  void begin(const State<D>& from, double duration);
  /// Sets what another participant gives at the conjugate faces for the end of the coupling step, per boundary face: the
  /// coefficient of a film [W/(m^2 K)], 0 at all other faces, and the temperature beyond it [K]. Within the step, that
  /// temperature changes linearly. Call before advance().
  void set_film(std::vector<double> coefficient, std::vector<double> ambient);
  /// Mean heat that left the fluid since begin(), per boundary face [W]; with the result of the last advance().
  std::vector<double> mean_heat() const;
  /// Makes the result of advance() the state's. Cannot fail.
  void commit(State<D>& state);

  /// T at t^{n+1/2} per local cell, and at the boundary faces, both less the reference temperature [K].
  const std::vector<double>& middle() const { return middle_; }
  const std::vector<double>& boundary_middle() const { return boundary_middle_; }
  /// True if the flow stays as it is from this time on.
  bool freezes_flow(double time) const {
    return parameters_.frozen_flow && time >= *parameters_.frozen_flow * (1 - 1e-12);
  }
  /// Largest frequency of internal waves of a stratified fluid, (-beta g . grad T)^(1/2) [1/s]. In a fluid at rest, any buoyancy
  /// between neighbors counts, because it will set the fluid in motion. Collective.
  double buoyancy_rate(const State<D>& state) const;

 private:
  // Weights of levels n+1, n and n-1: of the extrapolated convection, and of conduction.
  struct Weights {
    double e0, e1, a, b, c;
  };
  Weights weights() const;
  std::vector<double> through(const State<D>& state) const;
  void set_carried(const State<D>& from, const Weights& w);
  void carry(const State<D>& from, const Weights& w);
  void carry_implicitly();
  void carry_bounded(const State<D>& from, const Weights& w);
  void add_limited(const State<D>& from, std::span<const double> excess);
  void add_film();
  void add_flow(double share, std::span<const double> flow);
  void set_known(const Placement<D>& at);
  void close(const Placement<D>& at, std::span<const double> temperature,
             std::vector<double>& boundary) const;
  void conduct(const Placement<D>& at, std::span<const double> temperature, HeatLevel& level) const;
  void set_gradient(const Placement<D>& at, std::span<const double> temperature,
                    std::span<const double> boundary);
  double oblique_part(const Placement<D>& at, Index boundary_face) const;
  void solve(const HeatLevel& level, const Weights& w);
  void set_rows();
  void set_right_side();
  bool has_settled(int pass);
  void apply(std::span<const double> x, std::span<double> y);

  const Scene<D>& scene_;
  const mesh::Mesh& mesh_;
  const FluidStep<D>& step_;
  const HeatParameters& parameters_;
  double capacity_, diffusivity_;  // rho c [J/(m^3 K)], a [m^2/s]
  HeatBoundary<D> boundary_;
  linalg::KrylovSolver solver_;
  HeatExchange exchange_;  // at t^{n+1}
  HeatLevel next_;         // level n+1; its history becomes that of level n
  struct {
    double begin = 0, duration = 0;
    std::vector<double> coefficient, ambient;  // at the end
    std::vector<double> boundary, flow;        // of the level at the begin
  } film_;                                     // of a coupling step
  std::vector<double>
      carried_;  // volume that carries T^{n+1}, per flux face [m^3]; empty if that is explicit
  std::vector<double> conducted_, done_;  // in this sub-step and those before it, per boundary face [K m^3]
  std::vector<double> side_;              // V' T^{n+1} without conduction at n+1, per local cell [K m^3]
  std::unique_ptr<ViscousRows> rows_;
  std::vector<double> right_, before_, vector_;  // of the system, per local cell
  std::vector<double> admittance_, known_;       // flow at a boundary face: known - admittance T_P
  Vectors<D> gradient_;                          // of T [K/m], non-orthogonal meshes only
  double beta_ = 0;                              // diffusivity times dt times the weight of t^{n+1} [m^2]
  std::vector<double> middle_, boundary_middle_;
  std::unique_ptr<linalg::VectorAccelerator> accelerator_;  // for meshes that need many passes
};

/// Buoyancy after Boussinesq: -beta (T - T_ref) g per mass. At walls its pressure has the slope of the force at the wall itself:
/// with equal cells, a fluid whose T is linear along g then stays at rest.
template <int D>
class Buoyancy final : public Force<D> {
 public:
  Buoyancy(const mesh::Mesh& mesh, const HeatTransport<D>& heat, const HeatParameters& parameters);
  bool acts() const override { return true; }
  void add(double t, double dt, std::span<const Vec3> places, const Vectors<D>& u,
           Vectors<D>& force) const override;
  void add_beside_walls(Vectors<D>& beside) const override;
  std::function<double(const Vec3&)> potential(double) const override { return {}; }

 private:
  const mesh::Mesh& mesh_;
  const HeatTransport<D>& heat_;
  Vec<D> per_kelvin_;  // -beta g [m/(s^2 K)]
};

}  // namespace couplet::fluid
