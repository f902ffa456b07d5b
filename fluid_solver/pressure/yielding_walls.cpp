// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <vector>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "fluid_solver/pressure/opposite_faces.hpp"
#include "fluid_solver/pressure/term.hpp"

namespace couplet::fluid {
namespace {

// Share of the interface's area that must be opposite itself for a log entry.
constexpr double worth_telling = 0.05;

/// Checks that there are two sides where the case states that they move together. Collective.
void check_sides(const mesh::Mesh& mesh, const FluidParameters& parameters, const OppositeFaces& opposite) {
  for (const mesh::Patch& patch : mesh.patches) {
    if (parameters.boundaries.at(patch.name).sides != Sides::together) continue;
    const bool any = std::ranges::any_of(opposite.pairs(), [&](const OppositeFaces::Pair& pair) {
      const Index at = mesh.n_interior + pair.face - patch.first;
      return at >= 0 && at < patch.count;
    });
    if (!parallel::any(mesh.comm, any))
      throw Error(
          "boundaries.{}.sides: together, but none of its faces lies opposite another face of the interface, on the "
          "other side of a body no thicker than a quarter of the interface's extent; use 'auto' or 'apart'.",
          patch.name);
  }
}

/// Interface as a Robin condition: w follows from the structure's expected response, relative to the velocity
/// w^k that it gave for p_b^k. A single side with mass m per area and Z = m/dt has
///   Z (w - w^k) = p_b - p_b^k,   p_b = p_P + s - D (w - w^n),  D = rho S/(g dt),  normal to the wall
/// so its flux is that of w^k plus S (p_P + q)/(Z + D), q = s - D (w^k - w^n) - p_b^k [badia2008]. At
/// convergence p_b = p_b^k and w = w^k for any Z. Opposite faces of a thin body with the common area S'
/// respond to their pressure difference with both masses:
///   +- S' [(p_P + q) - (p_P + q)']/(Z + Z' + D + D')
/// This couples the cells of both sides in the matrix, which remains symmetric and positive.
template <int D>
class YieldingWalls final : public Term<D> {
 public:
  /// Collective.
  YieldingWalls(const Scene<D>& scene, const Step<D>& step, const Prediction<D>& prediction)
      : Term<D>(scene, step, prediction) {
    const mesh::Geometry geometry = mesh::compute_geometry(mesh_, scene_.points_at_rest);
    opposite_ = OppositeFaces(mesh_, geometry, scene_.boundary.faces_with_two_sides());
    check_sides(mesh_, scene_.parameters, opposite_);
    const std::size_t faces = std::size_t(mesh_.boundary.n_owned());
    alone_.assign(faces, 1.);
    std::vector<GlobalIndex> cell(std::size_t(opposite_.map().n_local()));
    for (std::size_t b = 0; b < faces; ++b)
      cell[b] = mesh_.cells.global(mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]);
    opposite_.map().update_ghosts(std::span<GlobalIndex>(cell));
    for (const auto& pair : opposite_.pairs()) {
      const Index f = mesh_.n_interior + pair.face;
      alone_[pair.face] -= pair.area / geometry.face_area[f].norm();
      couplings_.row.push_back(mesh_.owner[f]);
      couplings_.column.push_back(cell[pair.other]);
    }
    for (double& share : alone_) share = std::max(share, 0.);
    couplings_.value.assign(couplings_.row.size(), 0.);
    if (opposite_.share() > worth_telling)
      log::info(
          "Robin interface: {:.0f} % of it lies opposite itself, on the other side of a body {:.3g} m thick: there "
          "both sides move together (boundary key 'sides').",
          100 * opposite_.share(), opposite_.thickness());
  }

  bool sets_level() const override { return step_.yields; }
  double version() const override { return step_.yields; }
  const Couplings* couplings() const override { return &couplings_; }
  void add_to_diagonal(Diagonal& diagonal) override {
    std::vector<double>& admittance = diagonal.faces;
    admittance.resize(alone_.size(), 0.);
    std::fill(couplings_.value.begin(), couplings_.value.end(), 0.);
    if (!step_.yields) return;
    const Placement<D>& at = *step_.to;
    set_resistances();
    share();
    const double factor = scene_.fluid.rho / step_.dt;
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      const double area = at.area[mesh_.n_interior + static_cast<Index>(b)].norm();
      if (sides_[b].resistance > 0) admittance[b] += factor * area * alone_[b] / sides_[b].resistance;
    }
    for (std::size_t i = 0; i < couplings_.value.size(); ++i) {
      const auto& pair = opposite_.pairs()[i];
      const double both = factor * answer_of(pair);
      admittance[pair.face] += both;
      couplings_.value[i] = -both;
    }
  }
  void foresee(const State<D>& from, Projected<D>& out) override {
    if (!step_.yields) return;
    const Placement<D>& at = *step_.to;
    const double dt = step_.dt;
    set_resistances();
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      if (sides_[b].resistance == 0) continue;
      const Index f = mesh_.n_interior + static_cast<Index>(b), p = mesh_.owner[f];
      const double g = at.conductance[f];
      double source = -scene_.fluid.rho * (out.w[b] - from.w[b]).dot(at.area[f]) / (g * dt) -
                      scene_.boundary.wall_load()[b];
      if (!prediction_.force.empty()) source += scene_.fluid.rho * prediction_.force[p].dot(at.area[f]) / g;
      if (!out.gradient.empty()) source -= out.gradient[p].dot(at.oblique_of(f)) / g;
      sides_[b].pressure = source;
    }
    add_answers(out);
  }
  void after(Projected<D>& out) override {
    if (!step_.yields) return;
    for (std::size_t b = 0; b < alone_.size(); ++b)
      sides_[b].pressure = out.p[mesh_.owner[mesh_.n_interior + static_cast<Index>(b)]];
    add_answers(out);
  }

 private:
  using Term<D>::scene_;
  using Term<D>::mesh_;
  using Term<D>::step_;
  using Term<D>::prediction_;
  struct Side {
    double resistance = 0, pressure = 0;  // Z + D [kg/(m^2 s)], [Pa]
  };
  void set_resistances() {
    const Placement<D>& at = *step_.to;
    sides_.assign(std::size_t(opposite_.map().n_local()), {});
    for (std::size_t b = 0; b < scene_.boundary.wall_mass().size(); ++b) {
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      const double m = scene_.boundary.wall_mass()[b];
      if (m > 0)
        sides_[b].resistance = (m + scene_.fluid.rho * at.area[f].norm() / at.conductance[f]) / step_.dt;
    }
  }
  /// Updates the copies of opposite faces on other ranks.
  void share() { opposite_.map().update_ghosts(std::as_writable_bytes(std::span(sides_)), sizeof(Side)); }
  /// S'/(Z + Z' + D + D') [m^4 s/kg].
  double answer_of(const OppositeFaces::Pair& pair) const {
    const Side &here = sides_[std::size_t(pair.face)], &there = sides_[std::size_t(pair.other)];
    return here.resistance > 0 && there.resistance > 0 ? pair.area / (here.resistance + there.resistance) : 0;
  }
  /// Adds the response of walls to the pressures on their sides to velocities and fluxes.
  void add_answers(Projected<D>& out) {
    const Placement<D>& at = *step_.to;
    share();
    flux_.assign(alone_.size(), 0.);
    for (std::size_t b = 0; b < alone_.size(); ++b)
      if (sides_[b].resistance > 0)
        flux_[b] = at.area[mesh_.n_interior + static_cast<Index>(b)].norm() * alone_[b] * sides_[b].pressure /
                   sides_[b].resistance;
    for (const auto& pair : opposite_.pairs())
      flux_[std::size_t(pair.face)] += answer_of(pair) * (sides_[std::size_t(pair.face)].pressure -
                                                          sides_[std::size_t(pair.other)].pressure);
    for (std::size_t b = 0; b < alone_.size(); ++b) {
      if (sides_[b].resistance == 0) continue;
      const Index f = mesh_.n_interior + static_cast<Index>(b);
      out.w[b] += flux_[b] / at.area[f].squaredNorm() * at.area[f];
      out.phi[f] = out.w[b].dot(at.area[f]);
    }
  }

  OppositeFaces opposite_;
  std::vector<double> alone_;  // area that has nothing opposite, over that of the face, per boundary face
  std::vector<Side> sides_;    // per entry of the map
  std::vector<double> flux_;   // of answers, per boundary face [m^3/s]
  Couplings couplings_;
};

}  // namespace

template <int D>
std::unique_ptr<Term<D>> make_yielding_walls(const Scene<D>& scene, const Step<D>& step,
                                             const Prediction<D>& prediction) {
  return std::make_unique<YieldingWalls<D>>(scene, step, prediction);
}

template decltype(make_yielding_walls<2>) make_yielding_walls<2>;
template decltype(make_yielding_walls<3>) make_yielding_walls<3>;

}  // namespace couplet::fluid
