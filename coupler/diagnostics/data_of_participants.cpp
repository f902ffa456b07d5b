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

/// True if any rank's values differ bitwise.
bool differ(MPI_Comm comm, const coupling::Exchange& a, const coupling::Exchange& b) {
  return parallel::max(comm, a == b ? 0. : 1.) > 0;
}

double extent_of(MPI_Comm comm, const std::vector<Vec3>& points) {
  double most = 0;
  for (const Vec3& x : points) most = std::max(most, (x - points.front()).norm());
  return parallel::max(comm, most);
}

/// Detects two faults of participants that residuals do not explain: a response that ignores the input (a
/// solver whose guess meets its own tolerance), and a velocity that is not the rate of the displacement.
class DataOfParticipants final : public CouplingDiagnostic {
 public:
  explicit DataOfParticipants(const CouplingView& view) : view_(view) {
    const std::vector<Side>& sides = view.pass.sides();
    for (std::size_t s = 0; s < sides.size(); ++s) {
      answers_.push_back({.name = sides[s].name, .taken = {}, .given = {}});
      const coupling::Interface& i = sides[s].interface;
      if (find_datum(i.gives, "displacement") && find_datum(i.gives, "velocity"))
        motions_.push_back(
            {.side = s, .name = sides[s].name, .x = {}, .v = {}, .extent = extent_of(view.comm, i.vertices)});
    }
  }

  void begin_step() override {
    for (Answers& one : answers_) one.passes = one.looked = one.same = 0;
  }

  void answered(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given) override {
    Answers& one = answers_[side];
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
    for (const Answers& one : answers_)
      if (one.looked > 0 && 2 * one.same >= one.looked)
        text += fmt::format(
            " '{}' gave the same answer in {} of the last {} passes, though its input changed: its solver's "
            "tolerance is too loose for this coupling.",
            one.name, one.same, one.looked);
    return text;
  }

  void observe(diagnostics::Report& report) override {
    for (Motion& one : motions_) {
      if (one.reported) continue;
      add(one, values_of(view_.pass.given()[one.side], "displacement"),
          values_of(view_.pass.given()[one.side], "velocity"));
      if (one.steps <= judged_steps || !(one.largest > least_motion * one.extent) || !(one.rate_rate > 0))
        continue;
      const double end = one.rate_end / one.rate_rate, mean = one.rate_mean / one.rate_rate;
      const double factor = std::abs(end - 1) < std::abs(mean - 1) ? end : mean;
      if (!(std::abs(factor - 1) > doubtful)) continue;
      one.reported = true;
      report.findings.push_back(
          {.id = "velocity-and-displacement",
           .severity = factor < 0.5 || factor > 2 ? base::Severity::wrong : base::Severity::warning,
           .number = factor,
           .limit = 1 + doubtful,
           .sentence = fmt::format("velocity of '{}': {:.3g} times the rate of the displacement that it "
                                   "gives (limit 1 +- {:g}): the fluid sees a wall with another motion",
                                   one.name, factor, doubtful),
           .advice = "correct the 'velocity' [m/s] that this program gives"});
    }
  }

  void visit(io::Archive& archive) override {
    for (Motion& one : motions_) {
      const Side& side = view_.pass.sides()[one.side];
      archive.common("motion-" + one.name, one.rate_rate, one.rate_end, one.rate_mean, one.largest, one.steps,
                     one.reported);
      const auto order = side.order(view_.comm, coupling::Interface::Place::vertices);
      archive.field(order, "displacement-" + one.name, one.x, std::size_t(side.interface.dim));
      archive.field(order, "velocity-" + one.name, one.v, std::size_t(side.interface.dim));
    }
  }

 private:
  struct Answers {
    std::string name;
    coupling::Exchange taken, given;
    int passes = 0, looked = 0, same = 0;
  };
  struct Motion {
    std::size_t side;
    std::string name;
    std::vector<double> x, v;                           // of the last accepted step
    double rate_rate = 0, rate_end = 0, rate_mean = 0;  // sums of products over the run
    double extent = 0, largest = 0;                     // [m]
    int steps = 0;
    bool reported = false;
  };

  /// Compares v^{n+1} and (v^n + v^{n+1})/2 with (x^{n+1} - x^n)/dt, by least squares over the run.
  void add(Motion& one, const std::vector<double>& x, const std::vector<double>& v) const {
    std::array<double, 3> sums{};
    double most = 0;
    const bool known = one.steps > 0 && one.x.size() == x.size() && v.size() == x.size();
    for (std::size_t i = 0; known && i < x.size(); ++i) {
      const double rate = (x[i] - one.x[i]) / view_.dt;
      sums[0] += rate * rate, sums[1] += rate * v[i], sums[2] += rate * 0.5 * (v[i] + one.v[i]);
      most = std::max(most, std::abs(x[i]));
    }
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_DOUBLE, MPI_SUM, view_.comm);
    one.rate_rate += sums[0], one.rate_end += sums[1], one.rate_mean += sums[2];
    one.largest = std::max(one.largest, parallel::max(view_.comm, most));
    one.x = x, one.v = v;
    ++one.steps;
  }

  const CouplingView& view_;
  std::vector<Answers> answers_;
  std::vector<Motion> motions_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> data_of_participants(const CouplingView& view) {
  return std::make_shared<DataOfParticipants>(view);
}

}  // namespace couplet::coupler
