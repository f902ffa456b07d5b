// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/boundary/openings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/parallel/collective.hpp"

namespace couplet::fluid {
namespace {

// Of what went through an opening in either direction: that was no oscillation. Of what went through the largest: that
// was no trickle.
constexpr double always = 0.9, much = 0.1;

}  // namespace

Openings::Openings(const mesh::Mesh& mesh, const FluidParameters& parameters, bool at_rest) : mesh_(mesh) {
  for (const mesh::Patch& patch : mesh.patches) {
    const BoundaryParameters& b = parameters.boundaries.at(patch.name);
    const bool inlet = condition_of(b).passage == Passage::in;
    // A pressure that is given on purpose may push.
    const bool outlet = at_rest && gives_pressure(b) && b.pressure.text == "0";
    if (inlet || outlet) openings_.push_back({&patch, inlet});
  }
}

void Openings::add(std::span<const double> phi, double dt) {
  for (Opening& opening : openings_)
    for (Index f = opening.patch->first; f < opening.patch->first + opening.patch->count; ++f) {
      opening.net += phi[f] * dt;
      opening.gross += std::abs(phi[f]) * dt;
    }
}

std::vector<std::string> Openings::doubts() const {
  std::vector<double> sums;
  for (const Opening& opening : openings_) sums.insert(sums.end(), {opening.net, opening.gross});
  for (double& value : sums) value = parallel::sum(mesh_.comm, value);
  double largest = 0;
  for (std::size_t i = 1; i < sums.size(); i += 2) largest = std::max(largest, sums[i]);
  std::vector<std::string> doubts;
  for (std::size_t i = 0; i < openings_.size(); ++i) {
    const double wrong = openings_[i].inlet ? sums[2 * i] : -sums[2 * i], gross = sums[2 * i + 1];
    if (!(wrong > always * gross) || !(gross > much * largest)) continue;
    doubts.push_back(
        openings_[i].inlet
            ? fmt::format(
                  "inlet '{}': outflow {:.3g} m^3 (expected: none): implausible; its velocity must point "
                  "into the domain: check the signs",
                  openings_[i].patch->name, wrong)
            : fmt::format(
                  "outlet '{}': inflow {:.3g} m^3 (expected: none): questionable; the velocity of inflow "
                  "through an outlet is undetermined: make it an inlet, or prescribe the driving pressure",
                  openings_[i].patch->name, wrong));
  }
  return doubts;
}

}  // namespace couplet::fluid
