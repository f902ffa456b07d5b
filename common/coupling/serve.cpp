// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/serve.hpp"

#include <chrono>
#include <filesystem>

#include "common/base/error.hpp"
#include "common/coupling/wait.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {
namespace {

void dispatch(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm,
              Reply& reply) {
  const auto file = [&] { return std::filesystem::path(command.folder) / (name + ".h5"); };
  switch (command.op) {
    case Op::initialise:
      reply.interface = participant.initialise();
      reply.suggested_dt = participant.suggest_dt();
      return;
    case Op::begin_step:
      participant.begin_step(command.step);
      return;
    case Op::solve:
      reply.data = participant.solve(command.data);
      return;
    case Op::accept_step:
      reply.report = participant.accept_step();
      participant.write_monitors(command.time);
      if (command.output >= 0) participant.write_output(command.time, command.output);
      reply.suggested_dt = participant.suggest_dt();
      return;
    case Op::write_output:
      participant.write_output(command.time, command.output);
      return;
    case Op::save: {
      CheckpointWriter writer(comm, file());
      participant.save(writer);
      writer.close();
      return;
    }
    case Op::load: {
      CheckpointReader reader(comm, file());
      participant.load(reader);
      reply.suggested_dt = participant.suggest_dt();
      return;
    }
    case Op::finalise:
      return;
  }
  throw Error("The coupler sent command {}, which this program does not know.",
              static_cast<long>(command.op));
}

}  // namespace

Reply carry_out(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm) {
  const auto start = std::chrono::steady_clock::now();
  Reply reply;
  try {
    dispatch(command, participant, name, comm, reply);
  } catch (const SolveFailure& failure) {
    reply = Reply{};
    reply.status = Reply::Status::failure;
    reply.text = failure.what();
    reply.shorter_helps = dynamic_cast<const SchemeFailure*>(&failure) == nullptr;
  }
  reply.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return reply;
}

void serve(MPI_Comm coupler, MPI_Comm comm, const std::string& name, Participant& participant,
           const ServeObserver& observer) {
  const bool root = comm_rank(comm) == 0;
  for (;;) {
    observer.waiting();
    std::vector<char> bytes;
    if (root) bytes = receive_bytes(coupler, 0, command_tag, "");
    broadcast_bytes(comm, bytes, "");
    const Command command = unpack_command(bytes);
    observer.received(command);
    const Reply reply = carry_out(command, participant, name, comm);
    observer.done(command);
    if (command.op == Op::accept_step) observer.accepted(command, reply.report);
    if (root) send_bytes(coupler, 0, reply_tag, pack(reply), "the coupler to take a reply");
    if (command.op == Op::finalise) return;
  }
}

}  // namespace couplet
