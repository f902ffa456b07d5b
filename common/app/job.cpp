// SPDX-License-Identifier: Apache-2.0
#include "common/app/job.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "common/app/case/case_file.hpp"
#include "common/app/case/command_line.hpp"
#include "common/app/loop/step_loop.hpp"
#include "common/app/supervision/supervisor.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/coupling/wait.hpp"
#include "common/diagnostics/finding.hpp"
#include "common/log/log.hpp"
#include "common/log/progress.hpp"
#include "common/parallel/collective.hpp"
#include "common/parallel/mpi_start.hpp"

namespace couplet::app {
namespace {

constexpr int exit_failed = 1, exit_configuration = 2, exit_stopped = 3, exit_wrong = 4;

/// Index of this program on the launch line: from couplet-exec, whose programs are one application of the
/// launcher, or from the launcher.
int application_number() {
  if (const char* part = std::getenv("COUPLET_PART")) return std::atoi(part);
  int* number = nullptr;
  int found = 0;
  MPI_Comm_get_attr(MPI_COMM_WORLD, MPI_APPNUM, &number, &found);
  return found ? *number : 0;
}

Attendant introduce(const CommandLine& command_line, const Program& program, const CaseFile& file) {
  Attendant self;
  self.program = program.name;
  self.participant = file.participant;
  self.case_file = command_line.case_file.string();
  self.case_hash = file.hash;
  self.restart = command_line.restart_folder.string();
  self.named = !command_line.participant.empty();
  self.application = application_number();
  self.world_rank = parallel::comm_rank(MPI_COMM_WORLD);
  self.errors = file.errors;
  return self;
}

/// Locks the output folder, since two jobs in one would corrupt each other's files. The lock ends with the
/// process.
bool lock(const std::filesystem::path& name) {
  const int file = ::open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  // On file systems without locks there is no protection, but no refusal either.
  return file < 0 || ::flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

/// Finds the checkpoint to continue from and the changes of the case since. `is_driver` is true for the
/// program that drives the steps, which compares for all.
void find_restart(Job& job, const CommandLine& command_line, bool is_driver) {
  job.restart_folder = find_checkpoint(command_line.restart_folder, is_driver && job.rank == 0);
  job.restart_time = read_run_state(job.restart_folder).time;
  if (is_driver)
    for (const std::string& change :
         check_changes(job.restart_folder, job.simulation.keys, command_line.restart_with_changes))
      diagnostics::finding(job.rank, {.id = "changed-since-checkpoint",
                                      .sentence = "since the checkpoint: " + change,
                                      .subject = change});
  const double end = job.simulation.end_time;
  if (job.restart_time > end * (1 + 1e-9))
    throw Error(
        "--restart {}: its time, {:g} s, is beyond the end of the run ('simulation.end-time': {:g} s); set "
        "a later end-time.",
        command_line.restart_folder.string(), job.restart_time, end);
}

/// Prepares folders, log and restart. Collective over job.comm.
void prepare(Job& job, const CommandLine& command_line, bool is_coupler) {
  job.case_folder = command_line.case_file.parent_path();
  const std::filesystem::path output = job.case_folder / job.simulation.output_folder;
  job.output_folder = output / job.name;
  job.checkpoints = output / "checkpoints";
  std::error_code failed;
  if (job.rank == 0) std::filesystem::create_directories(job.output_folder, failed);
  if (parallel::any(job.comm, bool(failed)))
    throw Error("Cannot create the output folder {} ({}). It is set by `simulation.output.folder` of {}.",
                job.output_folder.string(), failed.message(), command_line.case_file.string());
  for (const std::filesystem::path& folder : {job.output_folder, job.checkpoints})
    if (parallel::any(job.comm, job.rank == 0 && std::filesystem::is_symlink(folder)))
      throw Error(
          "{} is a symbolic link; a run does not write through symbolic links. Move it, or set another "
          "`simulation.output.folder`.",
          folder.string());
  const bool is_driver = job.alone || is_coupler;
  if (parallel::any(job.comm, job.rank == 0 && (!lock(job.output_folder / ".lock") ||
                                                (is_driver && !lock(output / ".checkpoints.lock")))))
    throw Error(
        "The output folder {} is in use by another job that is still running. Wait for it to end, or choose "
        "another folder with --set simulation.output.folder=....",
        job.output_folder.string());
  base::hold_files();
  log::set_driver(is_driver);
  log::setup(job.name, job.rank, command_line.verbosity, (job.output_folder / (job.name + ".log")).string());
  job.restart_time = std::numeric_limits<double>::quiet_NaN();
  if (is_driver) job.simulation.keys = case_keys(*job.document, job.case_folder);
  if (!command_line.restart_folder.empty()) find_restart(job, command_line, is_driver);
}

/// Ends all programs of the job.
[[noreturn]] void leave(int code) {
  std::fflush(nullptr);
  // MPI_Abort would print a page of its own. Open MPI's launcher also ends a job if a process exits with such
  // a code, and a single process has no others to end.
  if (parallel::has_open_mpi_launcher() || parallel::comm_size(MPI_COMM_WORLD) == 1) ::_exit(code);
  MPI_Abort(MPI_COMM_WORLD, code);
  std::abort();
}

/// Reports an exception once per participant and ends all programs of the job.
[[noreturn]] void end_the_job(Supervisor& supervisor, const char* what, bool configuring) {
  if (supervisor.claim_report()) log::error("{}", what);
  supervisor.ending();
  leave(configuring ? exit_configuration : exit_failed);
}

/// Performs the handshake. A failure is reported once and ends the job, since no watch exists yet.
MPI_Comm join_the_job() {
  try {
    return shake_hands(MPI_COMM_WORLD);
  } catch (const HandshakeFailure& failure) {
    if (failure.speaker == parallel::comm_rank(MPI_COMM_WORLD))
      fmt::print(stderr, "couplet: The job cannot start: {}\n", failure.what());
    leave(exit_configuration);
  }
}

/// Rank of the first process that has read the case (a guest may not have), which reports for all.
int speaker(const std::vector<Attendant>& attendants) {
  for (const Attendant& a : attendants)
    if (a.case_hash != 0) return a.world_rank;
  return 0;
}

std::string ids_of(base::Severity least, bool with_neglected) {
  std::vector<std::string> ids;
  for (const diagnostics::Finding& f : diagnostics::findings())
    if (f.severity >= least && !diagnostics::is_accepted(f.id) && std::ranges::count(ids, f.id) == 0 &&
        (with_neglected || diagnostics::finding_id(f.id).about == diagnostics::FindingId::About::answer))
      ids.push_back(f.id);
  return base::join(ids);
}

/// Exit code of a completed run.
int code_of_findings(const Job& job, CommandLine::Strict strict) {
  using enum CommandLine::Strict;
  if (const int n = diagnostics::count(base::Severity::wrong, true); n > 0) {
    if (job.rank == 0)
      log::error(
          "The result is useless ({}, see above): exit code {}. To accept it anyway: '--accept ID' for all "
          "programs, or 'simulation.accept: [ID]'.",
          ids_of(base::Severity::wrong, true), exit_wrong);
    return exit_wrong;
  }
  const int n = strict == no ? 0 : diagnostics::count(base::Severity::warning, strict == effects);
  if (n == 0) return 0;
  if (job.rank == 0)
    log::error("--strict: the result is questionable ({} warning{} above: {}); the run counts as failed.", n,
               n == 1 ? "" : "s", ids_of(base::Severity::warning, strict == effects));
  return exit_failed;
}

/// Exit code of a program: 4 if a finding of any program requires it, unless one failed or was stopped. The launcher
/// gives the first code that is not 0.
int agreed(const std::array<int, 2>& worst, int code) {
  const auto [failed, found_wrong] = worst;
  if (code == exit_wrong && failed) return failed;
  return code == 0 && !failed && found_wrong ? exit_wrong : code;
}

/// Calls MPI_Finalize after all programs of the job have arrived. If a process dies while others wait in
/// MPI_Finalize, Open MPI's launcher (4.1 with PMIx 4.2) may deadlock forever; while they wait here it does
/// not. Returns the exit code required by the findings of all programs.
int leave_together(MPI_Comm programs, int code) {
  std::array<int, 2> worst{code == exit_wrong ? 0 : code, code == exit_wrong};
  MPI_Request all_here;
  MPI_Iallreduce(MPI_IN_PLACE, worst.data(), 2, MPI_INT, MPI_MAX, programs, &all_here);
  coupling::wait_politely(all_here, "the other programs to end");
  MPI_Finalize();
  return agreed(worst, code);
}

int attend(const CommandLine& command_line, const Program& program, const CaseFile& file,
           const std::string& label, MPI_Comm programs, std::optional<StartDeadline>& start_guard,
           const std::function<int(const Job&)>& run) {
  Supervisor supervisor(programs, label);
  log::setup(label, 0, command_line.verbosity);
  try {
    const std::vector<Attendant> attendants =
        roll_call(MPI_COMM_WORLD, introduce(command_line, program, file));
    Job job;
    job.members = members(attendants);
    const int world_rank = parallel::comm_rank(MPI_COMM_WORLD);
    int color = 0, rank = 0;
    for (const JobMember& m : job.members)
      if (m.participant == file.participant) color = int(&m - job.members.data());
    for (const Attendant& a : attendants)
      rank += a.participant == file.participant && a.world_rank < world_rank;
    FaultInjection faults(label, rank);
    job.supervisor = &supervisor;
    job.faults = &faults;
    job.enter(Phase::roll_call);
    const Attendance attendance = attendance_of(attendants, file.expected, file.coupled);
    if (!attendance.problem.empty()) {
      if (world_rank == speaker(attendants)) fmt::print(stderr, "couplet: {}\n", attendance.problem);
      all_agree_to_start(MPI_COMM_WORLD, true);
      supervisor.ending();  // the launcher ends the others after the first exit with this code
      return exit_configuration;
    }
    if (!all_agree_to_start(MPI_COMM_WORLD, false)) {
      supervisor.ending();
      return exit_configuration;
    }
    MPI_Comm_split(MPI_COMM_WORLD, color, world_rank, &job.comm);
    job.rank = parallel::comm_rank(job.comm);
    supervisor.set_rank(job.rank);
    for (const Attendant& a : attendants)
      if (!a.process.empty()) supervisor.add_guest(a.participant, a.process);
    job.name = file.participant;
    job.alone = attendance.alone;
    job.document = &*file.document;
    job.simulation = file.simulation;
    job.choices = file.choices;
    diagnostics::share_limit() = job.simulation.neglected_share;
    std::vector<std::string> accepted = job.simulation.accept;
    accepted.insert(accepted.end(), command_line.accept.begin(), command_line.accept.end());
    diagnostics::accept(accepted);
    prepare(job, command_line, program.is_coupler);
    job.enter(Phase::initialise);
    supervisor.limit_silence(job.simulation.hang_timeout);
    start_guard.reset();
    for (const std::string& doubt : file.doubts)
      diagnostics::finding(job.rank, {.id = "questionable-key", .sentence = doubt});
    const int code = run(job);
    supervisor.enter(Phase::waiting);  // for the others: no sign of life of this process is due
    if (code == 0 && Supervisor::has_stopped()) return exit_stopped;
    return code == 0 ? code_of_findings(job, command_line.strict) : code;
  } catch (const std::exception& error) {
    const bool of_the_user = dynamic_cast<const Error*>(&error) && !dynamic_cast<const SolveFailure*>(&error);
    end_the_job(supervisor, error.what(), of_the_user && supervisor.phase() <= Phase::initialise);
  }
}

}  // namespace

const JobMember* Job::find(const std::string& participant) const {
  for (const JobMember& m : members)
    if (m.participant == participant) return &m;
  return nullptr;
}

bool Job::has_linear_structures() const {
  bool found = false;
  for (const JobMember& m : members) {
    if (m.program != "solid_solver" && m.program != "plate_modal") continue;
    const std::string participant = "participants." + m.participant;
    if (config::text_of(*document, participant + ".kinematics") == "finite-strain" ||
        !config::keys_of(*document, participant + ".body").empty())  // a rigid body rotates
      return false;
    found = true;
  }
  return found;
}

MPI_Comm Job::connect(const std::string& participant) const {
  const JobMember* other = find(participant);
  if (other == nullptr)
    throw Error("Cannot connect '{}' to '{}', which is not part of the job.", name, participant);
  MPI_Comm peers;
  constexpr int tag = 100;
  MPI_Intercomm_create(comm, 0, MPI_COMM_WORLD, other->first_rank, tag, &peers);
  return peers;
}

int run_job(int argc, char** argv, const Program& program, const std::function<int(const Job&)>& run) {
  const ParsedCommandLine parsed =
      parse_command_line(argc, argv, {program.name, program.description, section_of(program)});
  if (parsed.exit_code) {
    fmt::print(*parsed.exit_code == 0 ? stdout : stderr, "{}", parsed.output);
    return *parsed.exit_code;
  }
  const CommandLine& command_line = parsed.command_line;
  if (command_line.task != CommandLine::Task::run) return answer(command_line, program);

  // Read by the mesh generation (gmsh) through the environment.
  if (command_line.allow_commands) ::setenv("COUPLET_ALLOW_COMMANDS", "1", 1);
  parallel::prepare_mpi_start();
  const CaseFile file = read_case(command_line, program);
  const std::string label = file.participant.empty() ? program.name : file.participant;
  // MPI's own start takes seconds on a busy machine.
  const double patience = file.simulation.hang_timeout > 0 ? std::max(file.simulation.hang_timeout, 4.0) : 0;
  std::optional<StartDeadline> start_guard(std::in_place, patience, label);
  MPI_Init(&argc, &argv);
  // Reduces the timer slack, because Linux adds 50 us to each short sleep by default.
  prctl(PR_SET_TIMERSLACK, 2000UL);
  const MPI_Comm programs = join_the_job();
  const int code = attend(command_line, program, file, label, programs, start_guard, run);
  start_guard.reset();
  std::fflush(nullptr);
  const int agreed_code = leave_together(programs, code);
  Supervisor::finished();
  return agreed_code;
}

}  // namespace couplet::app
