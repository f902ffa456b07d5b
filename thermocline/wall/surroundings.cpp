// SPDX-License-Identifier: Apache-2.0
#include "thermocline/wall/surroundings.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"

namespace couplet::thermocline {
namespace {

constexpr double cover_emissivity = 0.2;

Film combine(double convection, double surface, double surroundings4, const Ambient& air) {
  // eps sigma (T^4 - T_env^4), linearized about the surface temperature.
  const double radiation = 4 * cover_emissivity * stefan_boltzmann * std::pow(surface, 3);
  const double offset = cover_emissivity * stefan_boltzmann * (3 * std::pow(surface, 4) + surroundings4);
  Film film;
  film.coefficient = convection + radiation;
  film.reference = (convection * air.temperature + offset) / film.coefficient;
  return film;
}

double cubes(double a, double b) { return std::cbrt(a * a * a + b * b * b); }

}  // namespace

Air::Air(double t, double pressure) {
  density = pressure / (287.05 * t);
  viscosity = air_viscosity(t);
  conductivity = air_conductivity(t);
  prandtl = viscosity * specific_heat / conductivity;
  expansion = 1 / t;
}

double Air::rayleigh(double difference, double length) const {
  const double nu = viscosity / density;
  return 9.81 * expansion * std::abs(difference) * std::pow(length, 3) / (nu * nu) * prandtl;
}

double vertical_plate_nusselt(double ra, double pr) {
  const double part = std::pow(1 + std::pow(0.492 / pr, 9.0 / 16), 8.0 / 27);
  const double root = 0.825 + 0.387 * std::pow(ra, 1.0 / 6) / part;
  return root * root;
}

double cross_flow_nusselt(double re, double pr) {
  return 0.3 + 0.62 * std::sqrt(re) * std::cbrt(pr) / std::pow(1 + std::pow(0.4 / pr, 2.0 / 3), 0.25) *
                   std::pow(1 + std::pow(re / 282000, 0.625), 0.8);
}

double hot_plate_up_nusselt(double ra) { return ra < 1e7 ? 0.54 * std::pow(ra, 0.25) : 0.15 * std::cbrt(ra); }

double sky_temperature(double air) { return 0.0552 * std::pow(air, 1.5); }

Film side_film(double surface, double diameter, double height, const Ambient& air) {
  const Air film(0.5 * (surface + air.temperature), air.pressure);
  const double re = film.density * air.wind * diameter / film.viscosity;
  const double forced = cross_flow_nusselt(re, film.prandtl) * film.conductivity / diameter;
  const double still =
      vertical_plate_nusselt(film.rayleigh(surface - air.temperature, height), film.prandtl) *
      film.conductivity / height;
  const double around =
      0.5 * std::pow(sky_temperature(air.temperature), 4) + 0.5 * std::pow(air.temperature, 4);
  return combine(cubes(forced, still), surface, around, air);
}

Film roof_film(double surface, double diameter, const Ambient& air) {
  const Air film(0.5 * (surface + air.temperature), air.pressure);
  const double re = film.density * air.wind * diameter / film.viscosity;
  const double forced = 0.037 * std::pow(re, 0.8) * std::cbrt(film.prandtl) * film.conductivity / diameter;
  const double length = diameter / 4;
  const double still =
      hot_plate_up_nusselt(film.rayleigh(surface - air.temperature, length)) * film.conductivity / length;
  const double sky = std::pow(sky_temperature(air.temperature), 4);
  return combine(cubes(forced, still), surface, sky, air);
}

Enclosure::Enclosure(double radius, double height, const std::array<double, 3>& emissivities) {
  const double x = 1 + 0.5 * std::pow(height / radius, 2);
  disc_to_disc = x - std::sqrt(x * x - 1);
  const double disc = std::numbers::pi * radius * radius, side = 2 * std::numbers::pi * radius * height;
  const double to_side = 1 - disc_to_disc, from_side = to_side * disc / side;
  Eigen::Matrix3d view;
  view << 0, disc_to_disc, to_side, disc_to_disc, 0, to_side, from_side, from_side, 1 - 2 * from_side;
  const Eigen::Vector3d emissivity(emissivities.data());
  const Eigen::Vector3d area(disc, disc, side);
  // Radiosities J = eps sigma T^4 + (1 - eps) F J; net loss Q = A (J - F J).
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d reflection = (Eigen::Vector3d::Ones() - emissivity).asDiagonal();
  const Eigen::Matrix3d radiosity =
      (identity - reflection * view).inverse() * Eigen::Matrix3d(emissivity.asDiagonal());
  const Eigen::Matrix3d net = area.asDiagonal() * (identity - view) * radiosity;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) exchange[i][j] = 0.5 * (net(i, j) + net(j, i));  // symmetric up to rounding
  for (int i = 0; i < 3; ++i) {
    double others = 0;
    for (int j = 0; j < 3; ++j) others += j != i ? exchange[i][j] : 0;
    exchange[i][i] = -others;
  }
}

Ullage::Ullage(double gauge_pressure, double diameter, double height, const std::array<double, 3>& emissivity)
    : gauge_pressure_(gauge_pressure), enclosure_(diameter / 2, height, emissivity), height_(height) {
  area_ = 0.25 * std::numbers::pi * diameter * diameter;
  side_ = std::numbers::pi * diameter * height;
  const Air air(500, 101325 + gauge_pressure);
  capacity_ = air.density * air.specific_heat * area_ * height;
}

Ullage::UllageHeat Ullage::step(double dt, double liquid, double wall, double roof_cell,
                                double roof_conductance, double air_pressure) {
  const auto& x = enclosure_.exchange;
  const double pressure = air_pressure + gauge_pressure_;
  const double store = capacity_ / dt, before = gas_;
  const auto fourth = [](double t) { return stefan_boltzmann * t * t * t * t; };
  double disc = 0, side = 0;  // film times area, surface to gas [W/K]
  for (int iteration = 0; iteration < 30; ++iteration) {
    // Liquid below a cooler roof: Globe and Dropkin 1959, Nu = 0.069 Ra^(1/3) Pr^0.074 over the height;
    // otherwise at rest. Two films in series give this coefficient, so each is twice as large.
    const Air air(0.5 * (liquid + roof_), pressure), near_wall(0.5 * (wall + gas_), pressure);
    const double ra = liquid > roof_ ? air.rayleigh(liquid - roof_, height_) : 0;
    const double nu = std::max(1.0, 0.069 * std::cbrt(ra) * std::pow(air.prandtl, 0.074));
    disc = 2 * area_ * nu * air.conductivity / height_;
    side = side_ * vertical_plate_nusselt(near_wall.rayleigh(wall - gas_, height_), near_wall.prandtl) *
           near_wall.conductivity / height_;
    // Newton's method for the gas and the roof's surface with these films.
    const double gas_balance =
        store * (gas_ - before) + disc * (2 * gas_ - liquid - roof_) + side * (gas_ - wall);
    const double roof_balance = disc * (roof_ - gas_) + roof_conductance * (roof_ - roof_cell) +
                                x[1][0] * fourth(liquid) + x[1][1] * fourth(roof_) + x[1][2] * fourth(wall);
    const double gg = store + 2 * disc + side, gr = -disc, rg = -disc;
    const double rr = disc + roof_conductance + 4 * x[1][1] * fourth(roof_) / roof_;
    const double det = gg * rr - gr * rg;
    const double dg = (-gas_balance * rr + roof_balance * gr) / det,
                 dr = (-gg * roof_balance + rg * gas_balance) / det;
    gas_ += dg, roof_ += dr;
    if (!std::isfinite(gas_ + roof_)) throw SolveFailure("The ullage's heat balance has no solution.");
    if (std::abs(dg) + std::abs(dr) < 1e-9 * (gas_ + roof_)) break;
  }
  UllageHeat heat;
  heat.roof_surface = roof_;
  heat.wall_coefficient = (side + 4 * x[2][2] * fourth(wall) / wall) / side_;
  heat.into_roof = roof_conductance * (roof_ - roof_cell);
  heat.from_wall =
      side * (wall - gas_) + x[2][0] * fourth(liquid) + x[2][1] * fourth(roof_) + x[2][2] * fourth(wall);
  // The heat of the liquid closes the balance; it equals that of films and radiation to the tolerance.
  heat.from_liquid = heat.into_roof + store * (gas_ - before) - heat.from_wall;
  return heat;
}

}  // namespace couplet::thermocline
