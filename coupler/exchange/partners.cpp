// SPDX-License-Identifier: Apache-2.0
#include "coupler/exchange/partners.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
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

void ask_all(const std::vector<Partner*>& partners, const coupling::Command& command) {
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

}  // namespace couplet::coupler
