// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/pressure.hpp"

namespace couplet::fluid {

namespace {

// Share of the boundary fluxes that a moving wall may leave as a discretization error, and the speed of a
// fluid at rest [m/s]. Walls that move tangentially leave a share of their speeds as the error.
constexpr double largest_open_leftover = 0.1, least_speed = 1e-9, round_speed = 1e-6;

/// An incompressible fluid without an outlet requires boundary fluxes that sum to zero. The discretization
/// error of moving walls is distributed by area over the interface, or over all moving faces; a convective
/// outlet takes the net inflow.
template <int D>
class ClosedDomain final : public Term<D> {
 public:
  using Term<D>::Term;

  bool is_in_matrix() const override { return false; }
  void balance(const PressureEquation<D>& equation, Projected<D>& out) override {
    if (!equation.singular()) return;
    enum { total, size, adjustable_area, other_area, speeds };
    double sums[5] = {};
    for (std::size_t b = 0; b < out.w.size(); ++b) {
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      const double area = step_.to->area[f].norm();
      sums[total] += out.phi[f];
      sums[size] += std::abs(out.phi[f]);
      sums[speeds] += out.w[b].norm() * area;
      sums[scene_.boundary.is_adjustable(b) ? adjustable_area : other_area] += area;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_DOUBLE, MPI_SUM, mesh_.comm);
    const bool adjustable = sums[adjustable_area] > 0;
    // The flux through rotating walls is only round-off of their speeds.
    if (!adjustable && std::abs(sums[total]) > std::max(1e-6 * sums[size], 1e-12 * sums[speeds]))
      throw Error(
          "The fluid domain is closed, but the prescribed velocities give a net outflow of {:.6g} m^3/s. Add "
          "an outlet or correct the velocities.",
          sums[total]);
    // With a level that holds the volume, or walls that yield to one, only guesses of the wall's motion leave so much over. Of walls
    // without a structure keep_volume() has compared the displacements.
    if (adjustable && !scene_.boundary.has_convective_outlet() &&
        !(scene_.boundary.sealed() && scene_.boundary.interface_patches().empty()) &&
        scene_.parameters.volume_level == VolumeLevelBy::nobody && !scene_.boundary.yields() &&
        std::abs(sums[total]) > largest_open_leftover * sums[size] &&
        std::abs(sums[total]) > round_speed * sums[speeds] &&
        sums[size] > least_speed * (sums[adjustable_area] + sums[other_area]))
      throw Error(
          "The fluid domain is closed: at t = {:.6g} s the net outflow is {:.6g} m^3/s, which neither the prescribed "
          "velocities nor the interface motion balance. The pressure level that would push it through the interface is not "
          "computed: add an outlet (a small one far from the interface is enough).",
          step_.end(), sums[total]);
    const double correction = sums[total] / (adjustable ? sums[adjustable_area] : sums[other_area]);
    for (std::size_t b = 0; b < out.w.size(); ++b) {
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      if (adjustable && !scene_.boundary.is_adjustable(b)) continue;
      out.phi[f] -= correction * step_.to->area[f].norm();
      if (scene_.boundary.is_convective(b)) out.w[b] -= correction * step_.to->area[f].normalized();
    }
  }

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
};

/// Interface as a Robin condition: w follows from the structure's expected response, relative to the velocity
/// w^k that it gave for p_b^k. A wall with mass m per area and Z = m/dt has
///   Z (w - w^k) = p_b - p_b^k,   p_b = p_P + s - D (w - w^n),  D = rho S/(g dt),  normal to the wall
/// so its flux is that of w^k plus S (p_P + q)/(Z + D), q = s - D (w^k - w^n) - p_b^k [badia2008]. At
/// convergence p_b = p_b^k and w = w^k for any Z.
template <int D>
class YieldingWalls final : public Term<D> {
 public:
  using Term<D>::Term;

  void prepare(const State<D>&) override {
    const std::vector<double>& mass = scene_.boundary.wall_mass();
    resistance_.assign(std::size_t(mesh_.boundary.n_owned()), 0.);
    for (std::size_t b = 0; step_.yields && b < mass.size(); ++b)
      if (mass[b] > 0)
        resistance_[b] =
            (mass[b] + scene_.fluid.rho * area(b).norm() / step_.to->conductance[face(b)]) / step_.dt;
  }
  bool sets_level() const override { return step_.yields; }
  double version() const override { return step_.yields; }
  void add_to_diagonal(Diagonal& diagonal) override {
    std::vector<double>& admittance = diagonal.faces;
    admittance.resize(std::size_t(mesh_.boundary.n_owned()), 0.);
    const double factor = scene_.fluid.rho / step_.dt;
    for (std::size_t b = 0; b < resistance_.size(); ++b)
      if (resistance_[b] > 0) admittance[b] += factor * area(b).norm() / resistance_[b];
  }
  void foresee(const State<D>& from, Projected<D>& out) override {
    const Placement<D>& at = *step_.to;
    const double dt = step_.dt;
    for (std::size_t b = 0; b < resistance_.size(); ++b) {
      if (resistance_[b] == 0) continue;
      const Index f = face(b), p = mesh_.owner[f];
      const double g = at.conductance[f];
      double source = -scene_.fluid.rho * (out.w[b] - from.w[b]).dot(at.area[f]) / (g * dt) -
                      scene_.boundary.wall_load()[b];
      if (!prediction_.force.empty()) source += scene_.fluid.rho * prediction_.force[p].dot(at.area[f]) / g;
      if (!prediction_.beside_walls.empty())
        source += scene_.fluid.rho * prediction_.beside_walls[b].dot(at.area[f]) / g;
      if (!out.gradient.empty()) source -= out.gradient[p].dot(at.oblique_of(f)) / g;
      add_response(b, source, out);
    }
  }
  void after(Projected<D>& out) override {
    for (std::size_t b = 0; b < resistance_.size(); ++b)
      if (resistance_[b] > 0) add_response(b, out.p[mesh_.owner[face(b)]], out);
  }

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  Index face(std::size_t b) const { return mesh_.n_interior + static_cast<Index>(b); }
  auto area(std::size_t b) const { return step_.to->area[face(b)]; }
  /// Adds the response of a wall to a pressure on it to its velocity and flux.
  void add_response(std::size_t b, double pressure, Projected<D>& out) {
    const double flux = area(b).norm() * pressure / resistance_[b];
    out.w[b] += flux / area(b).squaredNorm() * area(b);
    out.phi[face(b)] = out.w[b].dot(area(b));
  }

  std::vector<double> resistance_;  // Z + D per boundary face, 0 without a wall that yields [kg/(m^2 s)]
};

}  // namespace

template <int D>
void add_wall_terms(const Scene<D>& scene, const FluidStep<D>& step, const Prediction<D>& prediction,
                    Terms<D>& terms) {
  add_term<ClosedDomain<D>>(scene.boundary.closed(), scene, step, prediction, terms);
  add_term<YieldingWalls<D>>(scene.boundary.yields(), scene, step, prediction, terms);
}

template decltype(add_wall_terms<2>) add_wall_terms<2>;
template decltype(add_wall_terms<3>) add_wall_terms<3>;

}  // namespace couplet::fluid
