// SPDX-License-Identifier: Apache-2.0
#include "coupler/diagnostics/data_guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/diagnostics/view.hpp"

namespace couplet::coupler {
namespace {

bool gives(const coupling::Interface& interface, const char* name) {
  return std::ranges::any_of(interface.gives,
                             [&](const coupling::Interface::Datum& d) { return d.name == name; });
}

/// Whether any rank's values differ in any bit.
bool differ(MPI_Comm comm, const coupling::Exchange& a, const coupling::Exchange& b) {
  return parallel::max(comm, a == b ? 0. : 1.) > 0;
}

const std::vector<double>& values(const coupling::Exchange& data, const char* name) {
  static const std::vector<double> none;
  const auto found = data.find(name);
  return found == data.end() ? none : found->second;
}

double extent_of(MPI_Comm comm, const std::vector<Vec3>& points) {
  double most = 0;
  if (!points.empty())
    for (const Vec3& x : points) most = std::max(most, (x - points.front()).norm());
  return parallel::max(comm, most);
}

}  // namespace

DataGuard::DataGuard(MPI_Comm comm, const std::vector<Side>& sides) : comm_(comm) {
  for (std::size_t s = 0; s < sides.size(); ++s) {
    answers_.push_back({.name = sides[s].name, .taken = {}, .given = {}});
    const coupling::Interface& i = sides[s].interface;
    if (gives(i, "displacement") && gives(i, "velocity"))
      motions_.push_back(
          {.side = s, .name = sides[s].name, .x = {}, .v = {}, .extent = extent_of(comm, i.vertices)});
  }
}

void DataGuard::start_step() {
  for (Answers& one : answers_) one.passes = one.looked = one.same = 0;
}

void DataGuard::answered(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given) {
  Answers& one = answers_[side];
  if (++one.passes < late) return;
  if (one.passes > late && differ(comm_, taken, one.taken)) {
    ++one.looked;
    one.same += differ(comm_, given, one.given) ? 0 : 1;
  }
  one.taken = taken, one.given = given;
}

std::string DataGuard::silent() const {
  std::string text;
  for (const Answers& one : answers_)
    if (one.looked > 0 && 2 * one.same >= one.looked)
      text += fmt::format(
          " '{}' gave the same answer in {} of the last {} passes, though its input changed: its solver's "
          "tolerance is too loose for this coupling.",
          one.name, one.same, one.looked);
  return text;
}

void DataGuard::add(Motion& one, const std::vector<double>& x, const std::vector<double>& v,
                    double dt) const {
  std::array<double, 3> sums{};
  double most = 0;
  const bool known = one.steps > 0 && one.x.size() == x.size() && v.size() == x.size();
  for (std::size_t i = 0; known && i < x.size(); ++i) {
    const double rate = (x[i] - one.x[i]) / dt;
    sums[0] += rate * rate, sums[1] += rate * v[i], sums[2] += rate * 0.5 * (v[i] + one.v[i]);
    most = std::max(most, std::abs(x[i]));
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_DOUBLE, MPI_SUM, comm_);
  one.rate_rate += sums[0], one.rate_end += sums[1], one.rate_mean += sums[2];
  one.largest = std::max(one.largest, parallel::max(comm_, most));
  one.x = x, one.v = v;
  ++one.steps;
}

std::vector<diagnostics::Finding> DataGuard::accepted(const std::vector<coupling::Exchange>& given, double dt) {
  std::vector<diagnostics::Finding> findings;
  for (Motion& one : motions_) {
    if (one.reported) continue;
    add(one, values(given[one.side], "displacement"), values(given[one.side], "velocity"), dt);
    if (one.steps <= judged_steps || !(one.largest > least_motion * one.extent) || !(one.rate_rate > 0))
      continue;
    const double end = one.rate_end / one.rate_rate, mean = one.rate_mean / one.rate_rate;
    const double factor = std::abs(end - 1) < std::abs(mean - 1) ? end : mean;
    if (!(std::abs(factor - 1) > doubtful)) continue;
    one.reported = true;
    findings.push_back(
        {.id = "velocity-and-displacement",
         .severity = factor < 0.5 || factor > 2 ? base::Severity::wrong : base::Severity::warning,
         .number = factor,
         .limit = 1 + doubtful,
         .sentence = fmt::format("velocity of '{}': {:.3g} times the rate of the displacement that it "
                                 "gives (limit 1 +- {:g}): the fluid meets a wall that moves otherwise",
                                 one.name, factor, doubtful),
         .advice = "correct what that program gives as 'velocity' [m/s]"});
  }
  return findings;
}

void DataGuard::visit(io::Archive& archive, const std::vector<Side>& sides) {
  for (Motion& one : motions_) {
    const Side& side = sides[one.side];
    archive.common("motion-" + one.name, one.rate_rate, one.rate_end, one.rate_mean, one.largest, one.steps,
                   one.reported);
    const auto order = side.order(comm_, coupling::Interface::Place::vertices);
    archive.field(order, "displacement-" + one.name, one.x, std::size_t(side.interface.dim));
    archive.field(order, "velocity-" + one.name, one.v, std::size_t(side.interface.dim));
  }
}

namespace {

/// Faults of participants that no residual shows by its cause (see DataGuard).
class DataOfParticipants final : public CouplingDiagnostic {
 public:
  explicit DataOfParticipants(const CouplingView& view) : view_(view), guard_(view.comm, view.pass.sides()) {}
  void begin_step() override { guard_.start_step(); }
  void answered(std::size_t side, const coupling::Exchange& taken, const coupling::Exchange& given) override {
    guard_.answered(side, taken, given);
  }
  void observe(diagnostics::Report& report) override {
    for (diagnostics::Finding& finding : guard_.accepted(view_.pass.given(), view_.dt))
      report.findings.push_back(std::move(finding));
  }
  std::string remark() const override { return guard_.silent(); }
  void visit(io::Archive& archive) override { guard_.visit(archive, view_.pass.sides()); }

 private:
  const CouplingView& view_;
  DataGuard guard_;
};

}  // namespace

std::shared_ptr<CouplingDiagnostic> data_of_participants(const CouplingView& view) {
  return std::make_shared<DataOfParticipants>(view);
}

}  // namespace couplet::coupler
