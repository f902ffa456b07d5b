// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

constexpr int late = 10;                ///< passes before which answers are not compared
constexpr int judged_steps = 10;        ///< before which the velocity is not judged
constexpr double doubtful = 0.3;        ///< deviation of the velocity, over the rate
constexpr double least_motion = 1e-12;  ///< over the interface's extent; below it nothing moves
/// Over the extent: no mesh follows a wall that far, and millimeters instead of meters give a factor of a thousand.
constexpr double farthest = 30;

/// True if any rank's values differ bitwise.
bool differ(MPI_Comm comm, const coupling::Exchange& a, const coupling::Exchange& b) {
  return parallel::max(comm, a == b ? 0. : 1.) > 0;
}

double extent_of(MPI_Comm comm, const std::vector<Vec3>& points) {
  double most = 0;
  for (const Vec3& x : points) most = std::max(most, (x - points.front()).norm());
  return parallel::max(comm, most);
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

/// Answers of a participant within a step.
struct Received {
  std::string name;
  coupling::Exchange taken, given;
  int passes = 0, looked = 0, same = 0;
};

/// Motion that a participant gives, over the run.
struct GivenMotion {
  std::size_t side;
  std::string name;
  bool has_velocity;
  std::vector<double> x, v;                           // of the last accepted step
  double rate_rate = 0, rate_end = 0, rate_mean = 0;  // sums of products over the run
  double extent = 0, largest = 0;                     // [m]
  int steps = 0;
  bool reported = false;
};

/// Detects faults of participants that residuals do not explain: a response that ignores the input (a solver whose
/// guess meets its own tolerance), a displacement in another unit, and a velocity that is not its rate.
class DataOfParticipants final : public CouplingDiagnostic {
 public:
  explicit DataOfParticipants(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t s = 0; s < sides.size(); ++s) {
      answers_.push_back({.name = sides[s].name, .taken = {}, .given = {}});
      const coupling::Interface& i = sides[s].interface;
      if (find_datum(i.gives, "displacement"))
        motions_.push_back({.side = s,
                            .name = sides[s].name,
                            .has_velocity = find_datum(i.gives, "velocity") != nullptr,
                            .x = {},
                            .v = {},
                            .extent = extent_of(view.comm, i.vertices)});
    }
  }

  void begin_step() override {
    for (Received& one : answers_) one.passes = one.looked = one.same = 0;
  }

  void received(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given) override {
    Received& one = answers_[side];
    if (++one.passes < late) return;
    if (one.passes > late && differ(view_.comm, taken, one.taken)) {
      ++one.looked;
      one.same += differ(view_.comm, given, one.given) ? 0 : 1;
    }
    one.taken = taken, one.given = given;
  }

  /// Names participants with identical responses to changed input in at least half of the recent passes.
  std::string remark() const override {
    std::string text;
    for (const Received& one : answers_)
      if (one.looked > 0 && 2 * one.same >= one.looked)
        text += fmt::format(
            " '{}' gave the same answer in {} of the last {} iterations although its input changed: its solver's "
            "tolerance is too loose for this coupling.",
            one.name, one.same, one.looked);
    return text;
  }

  void observe(diagnostics::Report& report) override {
    for (GivenMotion& one : motions_) {
      const std::vector<double>& x = values_of(view_.pass.given()[one.side], "displacement");
      const double most = parallel::max(view_.comm, largest(x));
      if (const double share = most / one.extent; one.extent > 0 && share > farthest)
        report.findings.push_back(
            {.id = "questionable-displacement",
             .number = share,
             .limit = farthest,
             .sentence =
                 fmt::format("displacement of '{}': {:.3g} times the extent of its interface, {:.3g} m "
                             "(limit {:g}): implausible",
                             one.name, share, one.extent, farthest),
             .advice = "check the unit of the 'displacement' [m] that this program gives",
             .subject = one.name});
      if (one.reported || !one.has_velocity) continue;
      one.largest = std::max(one.largest, most);
      add(one, x, values_of(view_.pass.given()[one.side], "velocity"));
      if (one.steps <= judged_steps || !(one.largest > least_motion * one.extent) || !(one.rate_rate > 0))
        continue;
      const double end = one.rate_end / one.rate_rate, mean = one.rate_mean / one.rate_rate;
      const double factor = std::abs(end - 1) < std::abs(mean - 1) ? end : mean;
      if (!(std::abs(factor - 1) > doubtful)) continue;
      one.reported = true;
      report.findings.push_back(
          {.id = "questionable-displacement",
           .severity = factor < 0.5 || factor > 2 ? base::Severity::wrong : base::Severity::warning,
           .number = factor,
           .limit = 1 + doubtful,
           .sentence = fmt::format("velocity of '{}': {:.3g} times the rate of the displacement that it "
                                   "gives (limit 1 +- {:g}): the fluid sees a wall that moves differently",
                                   one.name, factor, doubtful),
           .advice = "correct the 'velocity' [m/s] that this program gives",
           .subject = one.name + ", velocity"});
    }
  }

  void visit(io::Archive& archive) override {
    for (GivenMotion& one : motions_) {
      if (!one.has_velocity) continue;
      const Side& side = view_.pass.sides()[one.side];
      archive.common("motion-" + one.name, one.rate_rate, one.rate_end, one.rate_mean, one.largest, one.steps,
                     one.reported);
      const auto order = side.order(view_.comm, coupling::Interface::Place::vertices);
      archive.field(order, "displacement-" + one.name, one.x, std::size_t(side.interface.dim));
      archive.field(order, "velocity-" + one.name, one.v, std::size_t(side.interface.dim));
    }
  }

 private:
  /// Compares v^{n+1} and (v^n + v^{n+1})/2 with (x^{n+1} - x^n)/dt, by least squares over the run.
  void add(GivenMotion& one, const std::vector<double>& x, const std::vector<double>& v) const {
    std::array<double, 3> sums{};
    const bool known = one.steps > 0 && one.x.size() == x.size() && v.size() == x.size();
    for (std::size_t i = 0; known && i < x.size(); ++i) {
      const double rate = (x[i] - one.x[i]) / view_.dt;
      sums[0] += rate * rate, sums[1] += rate * v[i], sums[2] += rate * 0.5 * (v[i] + one.v[i]);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_DOUBLE, MPI_SUM, view_.comm);
    one.rate_rate += sums[0], one.rate_end += sums[1], one.rate_mean += sums[2];
    one.x = x, one.v = v;
    ++one.steps;
  }

  const CouplingView& view_;
  std::vector<Received> answers_;
  std::vector<GivenMotion> motions_;
};

constexpr int patience = 10;  // steps

/// Detects loaded structures that do not move at all, because their interface is held or the load does not
/// arrive. Even a stiff structure moves measurably.
class StructureAtRest final : public CouplingDiagnostic {
 public:
  explicit StructureAtRest(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t s = 0; s < sides.size(); ++s) {
      const coupling::Interface& i = sides[s].interface;
      if (!find_datum(i.gives, "displacement")) continue;
      RestingStructure one{.side = s, .loads = {}, .unit = {}};
      for (const auto& datum : i.takes)
        if (datum.unit == "N" || datum.unit == "Pa") one.loads.push_back(datum.name), one.unit = datum.unit;
      if (!one.loads.empty()) structures_.push_back(std::move(one));
    }
    steps_.resize(structures_.size());
  }
  void observe(diagnostics::Report& report) override {
    for (std::size_t k = 0; k < structures_.size(); ++k) {
      const RestingStructure& one = structures_[k];
      double load = 0;
      for (const std::string& name : one.loads)
        load = std::max(load, largest(values_of(view_.pass.taken()[one.side], name)));
      load = parallel::max(view_.comm, load);
      const double motion =
          parallel::max(view_.comm, largest(values_of(view_.pass.given()[one.side], "displacement")));
      steps_[k] = load > 0 && motion == 0 ? steps_[k] + 1 : 0;
      if (steps_[k] < patience) continue;
      const std::string& name = view_.pass.sides()[one.side].name;
      report.findings.push_back(
          {.id = "structure-at-rest",
           .sentence = fmt::format("motion of '{}': 0 m at every interface vertex for {} steps under a load "
                                   "of up to {:.3g} {} per face: the interface is held fixed; check its "
                                   "boundary conditions and `coupling`.",
                                   name, steps_[k], load, one.unit),
           .subject = name});
    }
  }
  void visit(io::Archive& archive) override { archive.common("steps", steps_); }

 private:
  struct RestingStructure {
    std::size_t side;
    std::vector<std::string> loads;
    std::string unit;  // of one of them, for the message
  };
  const CouplingView& view_;
  std::vector<RestingStructure> structures_;
  std::vector<int> steps_;  // of each in a row, under load and without motion
};

/// Forces at faces that no participant receives, relative to received ones: RMS over faces and steps.
class LostLoad final : public CouplingDiagnostic {
 public:
  explicit LostLoad(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t i = 0; i < sides.size(); ++i) {
      std::vector<LoadUse> forces;
      for (const coupling::Interface::Datum& datum : sides[i].interface.gives) {
        if (datum.unit != "N" || datum.place != coupling::Interface::Place::faces) continue;
        const bool taken = std::ranges::any_of(view.pass.links().all(), [&](const Links::Link& link) {
          return link.giver == i && link.datum.name == datum.name;
        });
        forces.push_back({i, datum.name, taken});
      }
      // If none are received, the coupling does not act by forces.
      if (std::ranges::any_of(forces, &LoadUse::taken) && !std::ranges::all_of(forces, &LoadUse::taken))
        forces_.insert(forces_.end(), forces.begin(), forces.end());
    }
  }
  bool empty() const { return forces_.empty(); }
  void observe(diagnostics::Report& report) override {
    std::array<double, 2> size{};  // of the forces that nobody takes, and of those that somebody does
    for (const LoadUse& force : forces_) {
      for (const double value : values_of(view_.pass.given()[force.giver], force.name))
        size[force.taken] += value * value;
    }
    MPI_Allreduce(MPI_IN_PLACE, size.data(), 2, MPI_DOUBLE, MPI_SUM, view_.comm);
    for (std::size_t k = 0; k < size.size(); ++k) squares_[k] += size[k];
    if (!(squares_[1] > 0)) return;
    const double lost = std::sqrt(squares_[0] / squares_[1]);
    if (auto finding = diagnostics::finding_of(
            {.effect = "viscous coupling load",
             .number = lost,
             .what = fmt::format("fluid forces not taken / taken by the structure = {:.2g}", lost),
             .advice =
                 "let the structure take 'viscous-force' as well ('interface: {load: forces}' of a solid)",
             .share = lost / (1 + lost)}))  // of all forces
      report.findings.push_back(std::move(*finding));
  }
  void visit(io::Archive& archive) override { archive.common("squares", squares_); }

 private:
  struct LoadUse {
    std::size_t giver;
    std::string name;
    bool taken;
  };
  const CouplingView& view_;
  std::vector<LoadUse> forces_;      // of sides of which one is not taken
  std::array<double, 2> squares_{};  // sums over the run
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> data_of_participants(const CouplingView& view) {
  return std::make_shared<DataOfParticipants>(view);
}

std::shared_ptr<CouplingDiagnostic> structure_at_rest(const CouplingView& view) {
  return std::make_shared<StructureAtRest>(view);
}

std::shared_ptr<CouplingDiagnostic> lost_load(const CouplingView& view) {
  auto made = std::make_shared<LostLoad>(view);
  return made->empty() ? nullptr : made;
}

}  // namespace couplet::coupler
