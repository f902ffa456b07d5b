// SPDX-License-Identifier: Apache-2.0
#include <chrono>

#include "common/app/job.hpp"
#include "common/app/run_report.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "coupler/coupler.hpp"
#include "coupler/parameters/parameters.hpp"

namespace {

int run(const couplet::app::Job& job, const couplet::coupler::CouplingParameters& read) {
  using namespace couplet;
  coupler::CouplingParameters parameters = read.in_force();
  parameters.loads_at_rest = job.has_linear_structures();
  std::vector<std::unique_ptr<coupling::Channel>> channels;
  for (const app::JobMember& m : job.members)
    if (m.participant != app::coupler_name)
      channels.push_back(
          std::make_unique<coupling::MpiChannel>(m.participant, job.connect(m.participant), job.comm));
  coupler::Coupler coupler(job.comm, parameters, job.simulation, std::move(channels),
                           {job.output_folder, job.checkpoints, job.restart_folder});
  coupler.on_phase([&](app::Phase phase, std::optional<double> time) {
    if (time) job.supervisor->set_time(*time);
    job.enter(phase);
  });
  const auto start = std::chrono::steady_clock::now();
  app::RunReport report(job, false);
  const std::string problem = coupler.run();
  report.total(coupler.time(), long(coupler.steps()), coupler.iterations());
  report.finish(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), problem,
                coupler.errors(), coupler.position());
  log::log_where(job.output_folder.parent_path().string(), "coupler/" + job.name + ".log");
  if (problem.empty()) return 0;
  if (job.rank == 0) log::error("{}", problem);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  couplet::coupler::CouplingParameters parameters;
  const couplet::app::Program program{
      .name = "coupler",
      .description =
          "couples a fluid, a structure and a mesh mover, or participants of any kind, each of which is a separate program",
      .declare = [&](couplet::config::Section& section) { declare(section, parameters); },
      .is_coupler = true};
  return couplet::app::run_job(argc, argv, program,
                               [&](const couplet::app::Job& job) { return run(job, parameters); });
}
