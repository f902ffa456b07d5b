// SPDX-License-Identifier: Apache-2.0
// Heat that a fluid exchanges with another participant, and long runs.
#include <fmt/format.h>

#include <algorithm>

#include "common/diagnostics/finding.hpp"
#include "common/parallel/collective.hpp"
#include "common/time/steadiness.hpp"
#include "fluid_solver/participant.hpp"

namespace couplet::fluid {

namespace {

// Change of a frozen flow, in a time as long as it ran before, from which it matters.
constexpr double most_frozen_change = 0.01;

std::vector<double> values_of(const coupling::Exchange& in, const char* name) {
  const auto given = in.find(name);
  return given == in.end() ? std::vector<double>{} : given->second;
}

}  // namespace

/// Without values yet, as in the first step, no heat passes.
template <int D>
void FluidParticipant<D>::take_film(const coupling::Exchange& in) {
  const std::vector<double> coefficient = conjugate_->scatter_faces(values_of(in, "film-coefficient"), 1),
                            ambient = conjugate_->scatter_faces(values_of(in, "ambient-temperature"), 1);
  std::vector<double> film(mesh_.boundary.n_owned(), 0.), beyond = film;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    const Index b = conjugate_->faces()[i] - mesh_.n_interior;
    film[b] = coefficient[i];
    beyond[b] = ambient[i];
  }
  fluid_->heat()->set_film(std::move(film), std::move(beyond));
}

template <int D>
void FluidParticipant<D>::give_heat(coupling::Exchange& out) const {
  const std::vector<double> heat = fluid_->heat()->mean_heat();
  std::vector<double> given;
  for (const Index face : conjugate_->faces()) given.push_back(heat[face - mesh_.n_interior]);
  out["heat"] = conjugate_->gather_faces(given, 1);
}

/// The flow is computed no longer than asked for.
template <int D>
double FluidParticipant<D>::suggest_dt() {
  const auto& heat = fluid_->parameters().heat;
  const double time = fluid_->state().time;
  if (!heat || !heat->frozen_flow || fluid_->heat()->freezes_flow(time))
    return coupling::Participant::suggest_dt();
  return *heat->frozen_flow - time;
}

/// The first step of a frozen flow tells how much the flow still changed before.
template <int D>
void FluidParticipant<D>::judge_frozen_flow() const {
  const State<D>& s = fluid_->state();
  if (!fluid_->heat() || s.u_old.empty() || !fluid_->heat()->freezes_flow(step_.time) ||
      fluid_->heat()->freezes_flow(step_.time - s.dt_old))
    return;
  const std::size_t owned = std::size_t(mesh_.cells.n_owned()) * D;
  const double change =
      time::change_over_size(mesh_.comm, flat<D>(s.u).first(owned), flat<D>(s.u_old)) / s.dt_old * step_.time;
  if (change <= most_frozen_change) return;
  diagnostics::finding(
      parallel::comm_rank(mesh_.comm),
      {.id = "frozen-flow",
       .number = change,
       .limit = most_frozen_change,
       .sentence = fmt::format(
           "the flow is frozen from t = {:g} s on, but at the last rate its velocity would change by {:.2g} % in as long "
           "again (limit {:g} %): set a later 'frozen-flow'",
           step_.time, 100 * change, 100 * most_frozen_change)});
}

/// Larger of that of the velocity and that of the temperature, over its range.
template <int D>
double FluidParticipant<D>::change() const {
  const State<D>& s = fluid_->state();
  if (s.u_old.empty()) return coupling::StepReport::unknown;
  const std::size_t owned = std::size_t(mesh_.cells.n_owned());
  double most = 0;
  if (!fluid_->heat() || !fluid_->heat()->freezes_flow(step_.time))
    most = time::change_over_size(mesh_.comm, flat<D>(s.u).first(owned * D), flat<D>(s.u_old));
  if (s.heat.is_solved)
    most = std::max(most, time::change_over_range(mesh_.comm, std::span(s.heat.temperature).first(owned),
                                                  s.heat.temperature_old));
  return most;
}

template void FluidParticipant<2>::take_film(const coupling::Exchange&);
template void FluidParticipant<2>::give_heat(coupling::Exchange&) const;
template void FluidParticipant<2>::judge_frozen_flow() const;
template double FluidParticipant<2>::suggest_dt();
template double FluidParticipant<2>::change() const;
template void FluidParticipant<3>::take_film(const coupling::Exchange&);
template void FluidParticipant<3>::give_heat(coupling::Exchange&) const;
template void FluidParticipant<3>::judge_frozen_flow() const;
template double FluidParticipant<3>::suggest_dt();
template double FluidParticipant<3>::change() const;

}  // namespace couplet::fluid
