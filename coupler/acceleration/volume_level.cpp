// SPDX-License-Identifier: Apache-2.0
#include "coupler/acceleration/volume_level.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/acceleration/accelerator.hpp"

namespace couplet::coupler {
namespace {

constexpr const char* inflow_name = "inflow";
constexpr const char* load_name = "pressure-force";
// Limits relative to the flow through the wall: round-off, and residual allowed to a structure's solver.
constexpr double exact = 1e-11, good_enough = 1e-6;
// Weight of the motion by the fluid's load in a step as a flow. Without flow, the level balances a load at
// rest (gravity), which then is the scale of the defect instead of round-off.
constexpr double resting = 1e-2;
constexpr int most_tries = 12;
// Damping of an oscillation per step (0.15 has the smallest spectral radius, 0.612), and the relative size
// that is ignored: it moves the level by less than a coupling tolerance of 1e-5 does.
constexpr double damping = 0.15, calm = 1e-4;
// Decay of the largest flow per step as a scale, because flows pass through zero.
constexpr double fading = 0.98;

}  // namespace

VolumeLevel::VolumeLevel(MPI_Comm comm, const std::vector<Side>& sides, const Links& links,
                         const Schedule& schedule, const std::vector<std::size_t>& group)
    : comm_(comm), links_(&links), loads_at_rest_(schedule.loads_at_rest) {
  const auto takes_of_cavity = [&](std::size_t i) {
    return std::ranges::any_of(links.all(), [&](const Links::Link& l) {
      return l.taker == i && l.datum.name == load_name &&
             find_datum(sides[l.giver].interface.gives, inflow_name);
    });
  };
  for (const std::size_t i : group) {
    if (takes_of_cavity(i)) structures_.push_back(i);
    if (!find_datum(sides[i].interface.gives, inflow_name)) continue;
    if (!schedule.iterates || schedule.side_by_side)
      throw Error(
          "'{}' is a closed fluid whose pressure level the structure determines, in the serial iteration of "
          "a step; use 'scheme: semi-implicit' or 'implicit' with 'order: serial'.",
          sides[i].name);
    if (!schedule.sub_steps.empty())
      throw Error(
          "coupling.sub-steps: the pressure level of the closed fluid '{}' (volume-level: structure) "
          "follows from the structure's motion at the end of the same step; remove 'sub-steps' and use a "
          "smaller time step.",
          sides[i].name);
    if (!structures_.empty())
      throw Error(
          "'{}' is a closed fluid whose pressure level the structure determines: it must precede '{}' in "
          "the order of a step.",
          sides[i].name, sides[structures_.front()].name);
    dim_ = sides[i].interface.dim;
    cavities_.push_back({i, sides[i].name, CavityWall(comm, sides[i], schedule.moved == sides[i].name)});
  }
  if (!cavities_.empty() && structures_.empty())
    throw Error(
        "No participant takes the '{}' of '{}', a closed fluid whose pressure level a structure "
        "must determine.",
        load_name, cavities_.front().name);
}

void VolumeLevel::start_step(double dt) {
  dt_ = dt;
  for (Cavity& c : cavities_) {
    c.level = c.accepted_level;
    const double swing = (c.swing[0] - c.swing[1]) / 2, beyond = std::abs(swing) - calm * c.flow;
    c.allowed = beyond > 0 ? damping * dt / 2 * std::copysign(beyond, swing) : 0;
  }
}

/// Applies the level to the mean area of the step, so that its work is that on the volume, or to that of a linear structure.
void VolumeLevel::add_level(std::size_t i, const coupling::Exchange& taken, coupling::Exchange& given) {
  const auto found = std::ranges::find(cavities_, i, &Cavity::side);
  if (found == cavities_.end()) return;
  found->load = values_of(given, load_name);
  found->areas = found->wall.areas(values_of(taken, "displacement"));
  if (!found->place.empty() && found->place.size() != values_of(taken, "displacement").size())
    throw Error("The checkpoint's index of the closed fluid '{}' is damaged. Use an earlier checkpoint.",
                found->name);
  const std::vector<Vec3> begin = found->wall.areas(found->place);
  for (std::size_t f = 0; f < begin.size(); ++f) found->areas[f] = (found->areas[f] + begin[f]) / 2;
  if (loads_at_rest_) found->areas = found->wall.areas({});
  put(*found, given);
}

void VolumeLevel::put(const Cavity& cavity, coupling::Exchange& given) const {
  std::vector<double>& load = given[load_name];
  load = cavity.load;
  load.resize(cavity.areas.size() * std::size_t(dim_), 0.);
  for (std::size_t f = 0; f < cavity.areas.size(); ++f)
    for (int c = 0; c < dim_; ++c)
      load[f * std::size_t(dim_) + std::size_t(c)] += cavity.level * cavity.areas[f][c];
}

/// Inflow at the end and at the start of the step [m^3/s].
std::array<double, 2> VolumeLevel::inflow(const Cavity& cavity,
                                          const std::vector<coupling::Exchange>& known) const {
  std::vector<double> sums(2, 0.);
  const std::vector<double>& shares = values_of(known[cavity.side], inflow_name);
  for (std::size_t k = 0; k < shares.size(); ++k) sums[k % 2] += shares[k];
  sum_over(comm_, sums);
  return {sums[0], sums[1]};
}

CavityFlow VolumeLevel::flow(const Cavity& c, const std::vector<coupling::Exchange>& known) const {
  const coupling::Exchange wall = links_->input(c.side, known);
  const std::vector<double>& place = values_of(wall, "displacement");
  const CavityWall::Flux flux = c.wall.flux(values_of(wall, "velocity"), c.wall.areas(place));
  std::array<double, 3> sums{flux.net, flux.size, c.wall.swept(c.place, place)};
  sum_over(comm_, sums);
  const auto [end, begin] = inflow(c, known);
  return {sums[0] - end, sums[1] + std::abs(begin) + std::abs(end), end, begin, sums[2]};
}

VolumeLevel::Mismatch VolumeLevel::defect(const std::vector<coupling::Exchange>& known) const {
  const auto n = Eigen::Index(cavities_.size());
  Mismatch d{Eigen::VectorXd(n), Eigen::VectorXd(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const Cavity& c = cavities_[std::size_t(k)];
    const CavityFlow now = flow(c, known);
    const double error = c.change + now.swept - c.inflow - dt_ / 2 * (now.begin + now.end);
    d.value[k] = 2 / dt_ * (error - c.allowed);
    d.size[k] = now.size + 2 / dt_ * std::abs(c.change - c.inflow);
  }
  return d;
}

VolumeLevel::Mismatch VolumeLevel::response_to(std::vector<coupling::Exchange>& known,
                                               const std::function<void()>& solve_structures) {
  for (const Cavity& c : cavities_) put(c, known[c.side]);
  solve_structures();
  return defect(known);
}

/// Root mean square of a load over the areas [Pa].
double VolumeLevel::pressure(const Cavity& c, const std::vector<double>& load) const {
  std::vector<double> sums(2, 0.);
  for (const double f : load) sums[0] += f * f;
  for (const Vec3& s : c.areas) sums[1] += s.squaredNorm();
  sum_over(comm_, sums);
  return sums[1] > 0 ? std::sqrt(sums[0] / sums[1]) : 0;
}

/// Response of the structure to an additional pressure in each cavity, of the size of the load.
void VolumeLevel::probe(std::vector<coupling::Exchange>& known, const std::function<void()>& solve_structures,
                        const Eigen::VectorXd& now) {
  slope_.resize(now.size(), now.size());
  for (Eigen::Index k = 0; k < now.size(); ++k) {
    Cavity& c = cavities_[std::size_t(k)];
    const double mean = pressure(c, values_of(known[c.side], load_name)), size = mean > 0 ? mean : 1,
                 before = c.level;
    c.level += size;
    slope_.col(k) = (response_to(known, solve_structures).value - now) / size;
    c.level = before;
  }
  slope_dt_ = dt_;
}

Eigen::VectorXd VolumeLevel::step_to(const Eigen::VectorXd& g) const {
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(slope_);
  if (!slope_.allFinite() || !lu.isInvertible())
    throw SolveFailure(
        "cannot determine a pressure in the closed fluid{} '{}' that conserves {} volume: the cavity has no "
        "compliant wall, or two cavities act on the same wall (singular system).",
        cavities_.size() > 1 ? "s beginning with" : "", cavities_.front().name,
        cavities_.size() > 1 ? "their" : "its");
  return lu.solve(-g);
}

void VolumeLevel::find(std::vector<coupling::Exchange>& known,
                       const std::function<void()>& solve_structures) {
  Mismatch now = defect(known);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(now.value.size());  // by the loads at rest [m^3/s]
  const auto measure = [&] {
    for (Eigen::Index k = 0; slope_dt_ == dt_ && k < moved.size(); ++k) {
      const Cavity& c = cavities_[std::size_t(k)];
      moved[k] = resting * std::abs(slope_(k, k)) * pressure(c, c.load);
    }
  };
  const auto share = [&](const Mismatch& d) {
    double worst = 0;
    for (Eigen::Index k = 0; k < d.value.size(); ++k)
      if (const double size = d.size[k] + moved[k]; size > 0)
        worst = std::max(worst, std::abs(d.value[k]) / size);
    return worst;
  };
  measure();
  double best = share(now);
  if (best <= exact) return;
  if (slope_dt_ != dt_) probe(known, solve_structures, now.value);
  measure();
  for (int k = 0; k < most_tries; ++k) {
    const Eigen::VectorXd change = step_to(now.value);
    for (Eigen::Index j = 0; j < change.size(); ++j) cavities_[std::size_t(j)].level += change[j];
    const Mismatch next = response_to(known, solve_structures);
    const double left = share(next);
    if (!std::isfinite(left)) break;
    // The residual of a structure's own solver gives no information about the slope.
    if (left > good_enough && change.squaredNorm() > 0)
      slope_ += next.value * change.transpose() / change.squaredNorm();
    if (left <= exact || (left <= good_enough && left > best / 2)) return;
    now = next;
    best = left;
  }
  throw SolveFailure(
      "the pressure level of the closed fluid '{}' did not converge in {} iterations: volume error {:.1e} "
      "of the flow through its wall.",
      cavities_.front().name, most_tries, best);
}

void VolumeLevel::accept(const std::vector<coupling::Exchange>& given) {
  for (Cavity& c : cavities_) {
    const CavityFlow now = flow(c, given);
    c.change += now.swept;
    c.inflow += dt_ / 2 * (now.begin + now.end);
    // The wall was at rest before the first step.
    c.swing = {now.mismatch, c.begun ? c.swing[0] : -now.begin};
    c.flow = std::max(now.size, fading * c.flow);
    c.begun = true;
    c.place = values_of(links_->input(c.side, given), "displacement");
    c.accepted_level = c.level;
  }
}

void VolumeLevel::visit(io::Archive& archive, const std::vector<Side>& sides) {
  std::size_t n = cavities_.size();
  std::vector<double> slope(slope_.data(), slope_.data() + slope_.size());
  archive.common("volume-level", n, slope_dt_, slope);
  if (n != cavities_.size() || (!slope.empty() && slope.size() != n * n))
    throw Error("The checkpoint is from a coupling with other closed fluids.");
  if (!slope.empty())
    slope_ = Eigen::Map<const Eigen::MatrixXd>(slope.data(), Eigen::Index(n), Eigen::Index(n));
  for (Cavity& c : cavities_) {
    archive.common("volume-level-" + c.name, c.accepted_level, c.change, c.inflow, c.swing, c.flow);
    archive.field(sides[c.side].order(comm_, coupling::Interface::Place::vertices), "volume-place-" + c.name,
                  c.place, std::size_t(dim_));
    c.begun = c.begun || archive.reads();
  }
}

std::vector<std::string> VolumeLevel::columns() const {
  std::vector<std::string> list;
  for (const Cavity& c : cavities_)
    for (const char* what : {"level [Pa]", "volume change [m^3]", "inflow [m^3]", "volume error [m^3]"})
      list.push_back(c.name + " " + what);
  return list;
}

std::vector<double> VolumeLevel::row() const {
  std::vector<double> list;
  for (const Cavity& c : cavities_)
    list.insert(list.end(), {c.accepted_level, c.change, c.inflow, c.change - c.inflow});
  return list;
}

}  // namespace couplet::coupler
