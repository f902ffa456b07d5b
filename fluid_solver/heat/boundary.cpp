// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <utility>

#include "fluid_solver/heat/heat.hpp"

namespace couplet::fluid {

template <int D>
HeatBoundary<D>::HeatBoundary(const mesh::Mesh& mesh, const FluidParameters& parameters)
    : mesh_(mesh), reference_(parameters.heat->reference_temperature) {
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const std::string where = "boundaries." + patch.name;
    const Passage passage = condition_of(b).passage;
    GivenHeat given{.faces = {patch.first - mesh.n_interior, patch.count}};
    if (b.temperature || (passage == Passage::in && !b.exchanges_heat())) {
      given.is_temperature = true;
      given.only_where_it_enters = passage == Passage::out;
      given.ambient = fv::Expression(b.temperature ? *b.temperature : parameters.heat->initial_temperature,
                                     b.temperature ? where + ".temperature" : "heat.initial-temperature");
    } else if (b.heat_flux) {
      given.flux = fv::Expression(*b.heat_flux, where + ".heat-flux");
    } else if (b.film) {
      given.coefficient = fv::Expression(b.film->coefficient, where + ".film.coefficient");
      given.ambient = fv::Expression(b.film->ambient, where + ".film.ambient");
    } else {
      continue;
    }
    if (patch.count > 0) patches_.push_back(std::move(given));
  }
}

template <int D>
void HeatBoundary<D>::set(double t, const Placement<D>& at, std::span<const double> through,
                          HeatExchange& e) const {
  const std::size_t n = at.boundary_centre.size();
  e.coefficient.assign(n, 0.0), e.ambient.assign(n, 0.0), e.flux.assign(n, 0.0);
  for (const GivenHeat& given : patches_) {
    const auto first = std::size_t(given.faces.first), count = std::size_t(given.faces.count);
    const std::span<const Vec3> places = std::span(at.boundary_centre).subspan(first, count);
    const auto of = [&](std::vector<double>& values) { return std::span(values).subspan(first, count); };
    given.flux.evaluate(places, t, of(e.flux));
    given.coefficient.evaluate(places, t, of(e.coefficient));
    given.ambient.evaluate(places, t, of(e.ambient));
    for (double& ambient : of(e.ambient)) ambient -= reference_;
    if (!given.is_temperature) continue;
    for (std::size_t i = 0; i < count; ++i)
      if (!given.only_where_it_enters || through[std::size_t(mesh_.n_interior) + first + i] < 0)
        e.coefficient[first + i] = std::numeric_limits<double>::infinity();
  }
}

template <int D>
void HeatBoundary<D>::set_outlets(double t, const Placement<D>& at, std::span<const double> through,
                                  std::span<const double> temperature, std::span<double> boundary) const {
  for (const GivenHeat& given : patches_) {
    if (!given.only_where_it_enters) continue;
    for (Index b = given.faces.first; b < given.faces.first + given.faces.count; ++b) {
      const Index f = mesh_.n_interior + b;
      boundary[b] =
          through[f] < 0 ? given.ambient(at.boundary_centre[b], t) - reference_ : temperature[mesh_.owner[f]];
    }
  }
}

template class HeatBoundary<2>;
template class HeatBoundary<3>;

template <int D>
Buoyancy<D>::Buoyancy(const mesh::Mesh& mesh, const HeatTransport<D>& heat, const HeatParameters& parameters)
    : mesh_(mesh), heat_(heat) {
  for (int c = 0; c < D; ++c) per_kelvin_[c] = -parameters.expansion * parameters.gravity[std::size_t(c)];
}

template <int D>
void Buoyancy<D>::add(double, double, std::span<const Vec3>, const Vectors<D>&, Vectors<D>& force) const {
  const std::vector<double>& middle = heat_.middle();
  for (std::size_t c = 0; c < force.size(); ++c) force[c] += middle[c] * per_kelvin_;
}

template <int D>
void Buoyancy<D>::add_beside_walls(Vectors<D>& beside) const {
  const std::vector<double>&inside = heat_.middle(), &at_wall = heat_.boundary_middle();
  beside.resize(at_wall.size(), Vec<D>::Zero());
  for (std::size_t b = 0; b < beside.size(); ++b)
    beside[b] += (at_wall[b] - inside[std::size_t(mesh_.owner[mesh_.n_interior + Index(b)])]) * per_kelvin_;
}

template class Buoyancy<2>;
template class Buoyancy<3>;

}  // namespace couplet::fluid
