// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/partners.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/coupling/roles.hpp"
#include "common/log/log.hpp"

namespace couplet::coupler {

coupling::Reply Partner::receive() {
  coupling::Reply reply = channel->receive();
  seconds += reply.seconds;
  seconds_since_accepted += reply.seconds;
  left = reply.status == coupling::Reply::Status::left;
  if (left || reply.status == coupling::Reply::Status::hopeless)
    throw SchemeFailure("'{}' reports: {}", name(), reply.text);
  if (reply.status == coupling::Reply::Status::failure)
    throw SolveFailure("'{}' reports: {}", name(), reply.text);
  return reply;
}

void command_all(const std::vector<Partner*>& partners, const coupling::Command& command) {
  for (Partner* p : partners) p->send(coupling::Command(command));
  std::string failures;
  for (Partner* p : partners) {
    try {
      const coupling::Reply reply = p->receive();
      if (command.op == coupling::Op::accept_step || command.op == coupling::Op::load)
        p->advised_dt = reply.suggested_dt;
      if (command.op != coupling::Op::accept_step) continue;
      p->report = reply.report;
      p->report.seconds = std::exchange(p->seconds_since_accepted, 0.0);
    } catch (const SolveFailure& failure) {
      failures += (failures.empty() ? "" : " ") + std::string(failure.what());
    }
  }
  if (!failures.empty()) throw SolveFailure(failures);
}

std::vector<coupling::Interface> initialise_all(const std::vector<Partner*>& partners) {
  std::vector<coupling::Interface> interfaces;
  for (Partner* p : partners) p->send({coupling::Op::initialise, {}, {}, 0, -1, ""});
  for (Partner* p : partners) {
    coupling::Reply reply = p->receive();
    p->advised_dt = reply.suggested_dt;
    p->introduction = std::move(reply.text);
    p->initial = std::move(reply.data);
    p->surfaces = std::move(reply.surfaces);
    interfaces.push_back(std::move(reply.interface));
  }
  return interfaces;
}

std::vector<diagnostics::NamedErrors> finalise_all(const std::vector<Partner*>& partners,
                                                   const std::string& problem,
                                                   std::vector<coupling::Exchange> last) {
  std::vector<diagnostics::NamedErrors> errors;
  for (std::size_t i = 0; i < partners.size(); ++i) {
    Partner* p = partners[i];
    p->send({coupling::Op::finalise, {}, std::move(last[i]), 0, -1, problem});
    const std::string text = p->receive().text;
    try {
      errors.push_back({p->name(), diagnostics::ErrorParts::of(text)});
    } catch (const Error& error) {  // of a guest: no reason to lose a run that has ended
      log::warn("Ignoring the malformed closing message of '{}': {}", p->name(), error.what());
    }
  }
  return errors;
}

double advised_dt(const std::vector<Partner*>& partners) {
  double dt = std::numeric_limits<double>::infinity();
  for (const Partner* p : partners) dt = std::min(dt, p->advised_dt);
  return dt;
}

namespace {

std::vector<std::string> parts(const std::string& text, char separator) {
  std::vector<std::string> list{""};
  for (const char c : text) {
    if (c == separator)
      list.emplace_back();
    else
      list.back() += c;
  }
  return list;
}

/// `record`: implicit or explicit, serial or parallel, and the participants of a serial scheme.
void check_scheme(const CouplingParameters& p, const std::string& who,
                  const std::vector<std::string>& record) {
  const auto& list = p.exchange->participants;
  const auto wanted = [&](std::size_t i, const auto& words) {
    return i < record.size() && std::ranges::find(words, record[i]) != words.end();
  };
  const auto refuse = [&](const char* key, const std::string& here, const std::string& there) {
    throw Error(
        "coupling.{}: {} here, but {} in the configuration that '{}' reads. Recreate the case with `couplet import "
        "FILE --force`.",
        key, here, there, who);
  };
  const std::string scheme = p.scheme == coupling::Scheme::explicit_ ? "explicit" : "implicit",
                    order = p.exchange->order == ExchangeParameters::Order::serial ? "serial" : "parallel";
  if (wanted(0, std::array{"implicit", "explicit"}) && record[0] != scheme)
    refuse("scheme", scheme, record[0]);
  if (wanted(1, std::array{"serial", "parallel"}) && record[1] != order)
    refuse("exchange.order", order, record[1]);
  if (wanted(2, list) && wanted(3, list) &&
      std::ranges::find(list, record[2]) > std::ranges::find(list, record[3]))
    refuse("exchange.participants", fmt::format("'{}' before '{}'", record[3], record[2]), "after it");
}

void check_dimensions(const std::vector<Side>& sides, const std::string& structure) {
  const Side& first = *std::ranges::find(sides, structure, &Side::name);
  for (const Side& other : sides)
    if (other.interface.dim != first.interface.dim)
      throw Error("'{}' has {} dimensions and '{}' has {}: both must have the same.", other.name,
                  other.interface.dim, first.name, first.interface.dim);
}

}  // namespace

std::string without_state(double checkpoint_interval, const std::vector<Partner>& partners) {
  const auto found = std::ranges::find_if(partners, &Partner::is_precice);
  if (found == partners.end()) return "";
  if (checkpoint_interval > 0)
    throw Error(
        "simulation.checkpoint.interval: {:g} s here, but '{}' is a program on preCICE's interface, which writes no checkpoint: such a job cannot continue from a checkpoint. Set it to 0.",
        checkpoint_interval, found->name());
  return fmt::format("'{}', a program on preCICE's interface, writes no checkpoint", found->name());
}

void check_introductions(const CouplingParameters& parameters, const std::vector<Partner>& partners) {
  const Partner* before = nullptr;
  for (const Partner& p : partners) {
    if (!p.is_precice()) continue;
    const std::vector<std::string> records = parts(p.introduction, '\x1e');
    if (before != nullptr && records[0] != parts(before->introduction, '\x1e')[0])
      throw Error(
          "'{}' and '{}' read different preCICE configurations: give both the same file. If it was edited, recreate the case "
          "with `couplet import FILE --force`.",
          before->name(), p.name());
    before = &p;
    if (!parameters.exchange || parameters.exchange->digest.empty()) continue;
    if (records[0] != parameters.exchange->digest)
      throw Error(
          "coupling.exchange.digest: '{}' reads a preCICE configuration that differs from the one this case was created from: "
          "either it was edited since, or it is a different file. Recreate the case with `couplet import FILE --force`.",
          p.name());
    for (std::size_t i = 1; i < records.size(); ++i)
      check_scheme(parameters, p.name(), parts(records[i], '\x1f'));
  }
}

void check_roles(const CouplingParameters& p, const std::vector<Side>& sides) {
  if (p.moves_alone()) return;  // neither has an interface
  if (!p.exchange && p.structure) check_dimensions(sides, p.structure->participant);
  const auto check = [&](const char* role, const auto& who) {  // as it is: a Role of it would be a copy
    if (!who) return;
    const auto side = std::ranges::find(sides, who->participant, &Side::name);
    if (side == sides.end()) return;
    const std::string problem =
        coupling::problem_of_role(coupling::contract_of(role), side->interface.takes, side->interface.gives);
    if (!problem.empty())
      throw Error("'{}' cannot be the {} (`coupling.{}`): {}.", side->name, role, role, problem);
  };
  // Data of other programs were checked individually.
  if (p.fluid && !p.fluid->foreign()) check("fluid", p.fluid);
  check("structure", p.structure);
  check("mesh", p.mesh);
}

}  // namespace couplet::coupler
