// SPDX-License-Identifier: Apache-2.0
#include "common/app/program.hpp"

#include <sched.h>

#include "common/app/job.hpp"
#include "common/app/run_report.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/config/load.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {
namespace {

coupling::Scheme scheme_of(const Job& job) {
  if (job.alone) return coupling::Scheme::standalone;
  const bool moves_alone = !config::text_of(*job.document, "coupling.structure.participant") &&
                           config::texts_of(*job.document, "coupling.exchange.participants").empty();
  if (moves_alone) return coupling::Scheme::explicit_;  // only a fluid and its mesh: no iteration is needed
  const std::string word = config::text_of(*job.document, "coupling.scheme").value_or("auto");
  if (word == "explicit") return coupling::Scheme::explicit_;
  return word == "implicit" ? coupling::Scheme::implicit : coupling::Scheme::semi_implicit;
}

/// Rank-to-rank link between fluid and mesh mover, if this participant is one of them.
MPI_Comm connect_mesh_peer(const Job& job) {
  const auto fluid = config::text_of(*job.document, "coupling.fluid.participant");
  const auto mover = config::text_of(*job.document, "coupling.mesh.participant");
  if (!fluid || !mover) return MPI_COMM_NULL;
  if (job.name == *fluid) return job.connect(*mover);
  if (job.name == *mover) return job.connect(*fluid);
  return MPI_COMM_NULL;
}

/// Writes the effective parameters, defaults included, beside the results.
void write_effective(const Job& job, const Program& program) {
  if (job.rank == 0)
    base::write_file(job.output_folder / "effective.yaml", config::effective(program.declare));
}

/// Warns where ranks share cores: they poll while they wait for each other. Collective.
void warn_of_shared_cores(const Job& job) {
  MPI_Comm here;
  MPI_Comm_split_type(job.comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  cpu_set_t cores;
  CPU_ZERO(&cores);
  ::sched_getaffinity(0, sizeof(cores), &cores);
  MPI_Allreduce(MPI_IN_PLACE, &cores, sizeof(cores), MPI_BYTE, MPI_BOR, here);
  const int ranks = parallel::comm_size(here), most = CPU_COUNT(&cores);
  MPI_Comm_free(&here);
  if (job.rank == 0 && most > 0 && ranks > most)
    log::warn(
        "'{}' has {} ranks on {} core{}: ranks poll while they wait for each other, so that the run takes several "
        "times as long as with {}.",
        job.name, ranks, most, most == 1 ? "" : "s", most);
}

int run(const Job& job, const Program& program) {
  const std::shared_ptr<void> environment = program.environment ? program.environment(job.comm) : nullptr;
  Supervisor::install();
  ParticipantContext context;
  context.comm = job.comm;
  context.name = job.name;
  context.case_folder = job.case_folder;
  context.output_folder = job.output_folder;
  context.simulation = job.simulation;
  context.coupled = !job.alone;
  context.scheme = scheme_of(job);
  context.restart_time = job.restart_time;
  context.loads_at_rest = job.has_linear_structures();
  MPI_Comm coupler = MPI_COMM_NULL;
  if (!job.alone) {
    coupler = job.connect(coupler_name);
    context.mesh_peer = connect_mesh_peer(job);
  }
  write_effective(job, program);
  log::info("{} runs '{}' with {} rank{}", program.name, job.name, parallel::comm_size(job.comm),
            parallel::comm_size(job.comm) == 1 ? "" : "s");
  warn_of_shared_cores(job);
  for (const diagnostics::EffectChoice& choice : job.choices) log::info("{}", diagnostics::text(choice));
  const std::unique_ptr<coupling::Participant> participant = program.make(context);
  return job.alone ? run_alone(job, *participant, program.diagnose)
                   : run_coupled(job, coupler, *participant, program.diagnose);
}

}  // namespace

int run_program(int argc, char** argv, const Program& program) {
  return run_job(argc, argv, program, [&](const Job& job) { return run(job, program); });
}

}  // namespace couplet::app
