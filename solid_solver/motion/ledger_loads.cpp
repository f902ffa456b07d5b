// SPDX-License-Identifier: Apache-2.0
// Work of what holds the body and of its loads.
#include "solid_solver/motion/ledger.hpp"

namespace couplet::solid {

/// What holds the known nodes does: against stress, springs and damping on their change, against inertia on the mean of
/// their velocities, so that the kinetic energy of both ends balances to rounding.
double SolidLedger::known_work(const SolvedStage& stage) const {
  const auto& [work, last, before, trial] = stage;
  const double dt = work.stage.dt;
  const std::vector<double> still(last.unknowns.size(), 0);
  const elastic::ElasticField w{last.unknowns, work.known}, known{still, work.known_change};
  double sum = kernel_.product(elastic::ElasticPart::stiffness, w, known) +
               kernel_.product(elastic::ElasticPart::springs, w, known);
  if (!body_.prescribed().uses_time()) return sum;  // not by the size: a rank may hold nothing
  // The mean over the stage, which the trapezoidal rule has at its place.
  const std::vector<double> after = body_.unknowns_of(trial.cell_v, trial.face_v);
  std::vector<double> rate = body_.unknowns_of(before.cell_v, before.face_v), velocity = rate;
  for (std::size_t i = 0; i < rate.size(); ++i) {
    velocity[i] = 0.5 * (after[i] + rate[i]);
    rate[i] = (after[i] - rate[i]) / dt;
  }
  const double start = work.place_time - 0.5 * dt;
  std::vector<double> way(before.known_rate.size());  // whose rate at the start of the run nobody has set
  body_.prescribed().evaluate_rate(start, dt, way);
  for (std::size_t i = 0; i < way.size(); ++i) way[i] = 0.5 * dt * (way[i] + trial.known_rate[i]);
  sum +=
      kernel_.product(elastic::ElasticPart::mass, {rate, body_.known_acceleration(start, dt)}, {still, way});
  if (parameters_.damping && parameters_.damping->mass > 0)
    sum += parameters_.damping->mass * kernel_.product(elastic::ElasticPart::mass,
                                                       {velocity, body_.known_velocity(start, dt)},
                                                       {still, work.known_change});
  return sum;
}

void SolidLedger::add_load_work(const StageWork& work, const LastSolve& last, const BodyField& before,
                                SolidState& after) const {
  const int dim = mesh_.dim;
  double sum = 0;
  if (body_.has_mass()) {
    for (std::size_t i = 0; i < std::size_t(mesh_.cells.n_owned()) * dim; ++i)
      sum += last.load_rows[i] * (after.cell_u[i] - before.cells[i]);
    std::size_t row = std::size_t(mesh_.cells.n_owned()) * dim;
    for (const Index f : elastic_.unknown_faces())
      for (int a = 0; a < dim; ++a) {
        const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
        sum += last.load_rows[row++] * (after.face_u[b] - before.faces[b]);
      }
    after.load_work += sum;
    return;
  }
  if (!work.rhs.empty())
    for (std::size_t i = 0; i < std::size_t(mesh_.cells.n_owned()) * dim; ++i)
      sum += work.rhs[i] * (after.cell_u[i] - before.cells[i]);
  for (const Index f : elastic_.unknown_faces())
    for (int a = 0; a < dim; ++a) {
      const std::size_t b = std::size_t(f - mesh_.n_interior) * dim + a;
      const double force = work.face_force[b] + (last.interface.empty() ? 0 : last.interface[b]);
      sum += force * (after.face_u[b] - before.faces[b]);
    }
  after.load_work += sum;
}

}  // namespace couplet::solid
