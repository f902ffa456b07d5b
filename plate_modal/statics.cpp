// SPDX-License-Identifier: Apache-2.0
// Static deflection: of the plate itself where there is a mesh, and by its modes beside it.
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/log/log.hpp"
#include "common/mesh/on_root.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {

/// q = Q / omega^2 of each mode; beside it K u = f on rank 0.
void Structure::solve_static(double t, std::span<const double> fluid) {
  std::vector<double> load(fluid.size(), 0);
  if (pressure_) add_pressure(t, load);
  for (std::size_t m = 0; m < load.size(); ++m) {
    trial_.q[m] = (load[m] + fluid[m] + gravity_[m]) / (share_->omega()[m] * share_->omega()[m]);
    trial_.v[m] = 0;
  }
  // The same loads again: the same answer.
  const bool first = !repeats_;
  repeats_ = trial_.q == solved_ && trial_.q == state_.q;
  if (repeats_) {
    if (first && parallel::comm_rank(context_.comm) == 0)
      log::info("the loads do not change from step to step, so the constant deflection is written once");
    return;
  }
  solved_ = trial_.q;
  std::vector<double> by_modes = share_->gather_vertices(trial_.q);
  mesh::on_root(context_.comm, [&] {
    look_at_pressure(t);
    if (!built_.plate) return;
    direct_ = direct_deflection(t);
    Deflection& d = deflection_.emplace(Deflection{});
    for (std::size_t i = 0; i < direct_.size(); ++i) {
      d.direct = std::max(d.direct, std::abs(direct_[i]));
      d.by_modes = std::max(d.by_modes, std::abs(by_modes[i]));
      d.apart = std::max(d.apart, std::abs(direct_[i] - by_modes[i]));
    }
    log::info("static deflection: max {:.6e} m; by {} modes {:.6e} m; max difference {:.2e} m", d.direct,
              share_->n_modes(), d.by_modes, d.apart);
  });
}

std::vector<double> Structure::cell_pressures(double t) const {
  const PlateModel& plate = *built_.plate;
  const Midsurface& s = plate.surface();
  const Placement& place = parameters_.placement;
  const Vec3 normal = place.normal();
  std::vector<double> pressure(s.cells.size(), 0);
  for (Index c = 0; c < s.cells.size(); ++c) {
    Vec2 middle = Vec2::Zero();
    for (const Index p : s.cells[c]) middle += s.points[p] / double(s.cells[c].size());
    const double half = 0.5 * plate.cell(c).thickness;
    if (pressure_ && pressure_->upper())
      pressure[c] -= pressure_->value(*pressure_->upper(), place.place(middle, half), t);
    if (pressure_ && pressure_->lower())
      pressure[c] += pressure_->value(*pressure_->lower(), place.place(middle, -half), t);
    if (!parameters_.gravity.empty())
      pressure[c] += plate.cell(c).surface_density() * normal.dot(Vec3(parameters_.gravity.data()));
  }
  return pressure;
}

std::vector<double> Structure::direct_deflection(double t) const {
  const PlateModel& plate = *built_.plate;
  const modes::EigenModes one{{0}, {plate.deflect(plate.load_of(cell_pressures(t)))}, 0, 0};
  return skin_of(plate, one, parameters_.placement, parameters_.wetted,
                 std::vector<bool>(plate.surface().patches.size(), false))
      .vertex_shape;
}

}  // namespace couplet::plate
