// SPDX-License-Identifier: Apache-2.0
#include "common/app/job.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "coupler/effect_cards.hpp"
#include "coupler/exchange_run.hpp"

namespace {

int run(const couplet::Job& job, const couplet::CouplingParameters& parameters) {
  using namespace couplet;
  log::info("{}", summary(effects_of(coupling_effect_cards(), parameters)));
  std::map<std::string, MPI_Comm> peers;
  for (const Member& m : job.members)
    if (m.participant != coupler_name) peers[m.participant] = job.connect(m.participant);
  const auto channel = [&](const std::string& name) -> std::unique_ptr<Channel> {
    return std::make_unique<MpiChannel>(name, peers.at(name));
  };
  const auto on_phase = [&](Phase phase, std::optional<double> time) {
    if (time) job.watch->set_time(*time);
    job.enter(phase);
  };
  const CouplerFolders folders{job.output_folder, job.checkpoints, job.restart_folder};
  std::string problem;
  if (parameters.exchange) {
    std::vector<std::unique_ptr<Channel>> channels;
    for (const std::string& name : parameters.exchange->participants) channels.push_back(channel(name));
    ExchangeRun exchange(parameters, job.simulation, std::move(channels), folders);
    exchange.on_phase(on_phase);
    problem = exchange.run();
  } else {
    CouplerChannels channels{channel(parameters.fluid->participant),
                             channel(parameters.structure->participant), nullptr};
    if (parameters.mesh) channels.mesh = channel(parameters.mesh->participant);
    Coupler coupler(parameters, job.simulation, std::move(channels), folders);
    coupler.on_phase(on_phase);
    problem = coupler.run();
  }
  if (problem.empty()) return 0;
  log::error("{}", problem);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  couplet::CouplingParameters parameters;
  const couplet::ProgramKind kind{
      "coupler",
      "couples a fluid, a structure and a mesh mover, or participants of any kind, each a program of its own",
      true, [&](couplet::config::Section& section) { declare(section, parameters); },
      [&](const couplet::EffectScene&) {
        return couplet::effects_of(couplet::coupling_effect_cards(), parameters);
      }};
  return couplet::run_job(argc, argv, kind, [&](const couplet::Job& job) { return run(job, parameters); });
}
