// SPDX-License-Identifier: Apache-2.0

#include <chrono>
#include <filesystem>

#include "common/base/error.hpp"
#include "common/coupling/channel.hpp"
#include "common/coupling/step_plan.hpp"
#include "common/coupling/wait.hpp"
#include "common/io/checkpoint.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupling {
namespace {

/// Checks that all ranks list the same data. The coupler uses the list of rank 0, so data of a rank with
/// another list would be ignored silently. A rank may have no list if rank 0 describes everything.
void check_lists(MPI_Comm comm, const Interface& interface) {
  const auto described = [&](const std::vector<Interface::Datum>& takes,
                             const std::vector<Interface::Datum>& gives) {
    Reply lists;
    lists.interface.dim = interface.dim;
    lists.interface.takes = takes, lists.interface.gives = gives;
    return pack(lists, Partition{});
  };
  const std::vector<char> here = described(interface.takes, interface.gives);
  std::vector<char> first = here;
  broadcast_bytes(comm, first, "");
  const bool differs = here != first && here != described({}, {});
  const int rank = static_cast<int>(parallel::max(comm, differs ? parallel::comm_rank(comm) : -1));
  if (rank >= 0)
    throw Error(
        "Rank {} describes different data to give or take than rank 0. All ranks must describe the same "
        "data, including ranks without faces, or rank 0 alone describes them.",
        rank);
}

void dispatch(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm,
              Reply& reply) {
  const auto file = [&] { return std::filesystem::path(command.folder) / (name + ".h5"); };
  switch (command.op) {
    case Op::initialise:
      reply.interface = participant.initialise();
      check_lists(comm, reply.interface);
      reply.suggested_dt = participant.suggest_dt();
      return;
    case Op::begin_step:
      participant.begin_step(command.step);
      return;
    case Op::solve:
      reply.data = participant.solve(command.data);
      reply.renewed = participant.renewed_prediction();
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
      io::CheckpointWriter writer(comm, file());
      participant.save(writer);
      writer.close();
      return;
    }
    case Op::load: {
      io::CheckpointReader reader(comm, file());
      participant.load(reader);
      reply.suggested_dt = participant.suggest_dt();
      return;
    }
    case Op::finalise:
      return;
    case Op::start:  // for participants with values before the first step
      break;
  }
  throw Error("The coupler sent command {}, which is unknown to this program.",
              static_cast<long>(command.op));
}

Partition cut_of(MPI_Comm comm, const Interface& interface) {
  const auto cut = [&](std::size_t n) {
    return starts_of(parallel::all_gather(comm, std::vector<GlobalIndex>{GlobalIndex(n)}));
  };
  return {cut(interface.vertices.size()), cut(interface.face_centres.size())};
}

/// This rank's part of the rank-to-rank exchange of values, vertices and faces.
class Ranks {
 public:
  Ranks(MPI_Comm coupler, MPI_Comm comm, std::string name)
      : coupler_(coupler), comm_(comm), name_(std::move(name)) {}

  /// Sends vertices and faces. `announced` holds dimension and data of rank 0.
  void send_places(const Interface& interface, const Interface& announced, const Partition& cut) {
    interface_ = announced;
    mine_ = cut;
    int ranks = 0;
    MPI_Comm_remote_size(coupler_, &ranks);
    plan_ = exchanged(mine_, parallel::comm_rank(comm_),
                      {even_starts(mine_.vertices.back(), ranks), even_starts(mine_.faces.back(), ranks)});
    for (const auto& [other, slice] : plan_)
      send_bytes(coupler_, other, places_tag, cut_out(interface, slice),
                 "the coupler to receive the "
                 "interface geometry");
  }

  /// Receives values of the names in the head. A rank without vertices and faces receives none.
  void receive(Exchange& data) const {
    const auto list = present(data, interface_.takes, name_);
    const auto rank = std::size_t(parallel::comm_rank(comm_));
    for (const auto& datum : list) {
      const Starts& starts = datum.place == Interface::Place::vertices ? mine_.vertices : mine_.faces;
      const auto entries = std::size_t(starts[rank + 1] - starts[rank]);
      if (entries == 0)
        data.erase(datum.name);
      else
        data[datum.name].resize(entries * std::size_t(datum.size(interface_.dim)));
    }
    std::vector<Interface::Datum> here;
    for (const auto& datum : list)
      if (data.contains(datum.name)) here.push_back(datum);
    for (const auto& [other, slice] : plan_)
      if (const auto to = places_in(data, here, interface_.dim, slice, name_); !to.empty())
        receive_stretches(coupler_, other, input_tag, to, "the coupler to send values");
  }

  void send(const Exchange& data) const {
    const auto list = present(data, interface_.gives, name_);
    const auto rank = std::size_t(parallel::comm_rank(comm_));
    for (const auto& datum : list) {
      const Starts& starts = datum.place == Interface::Place::vertices ? mine_.vertices : mine_.faces;
      const auto wanted =
          std::size_t(starts[rank + 1] - starts[rank]) * std::size_t(datum.size(interface_.dim));
      if (data.at(datum.name).size() != wanted)
        throw Error("'{}' gave {} values of '{}', but its interface has room for {}.", name_,
                    data.at(datum.name).size(), datum.name, wanted);
    }
    SendAll sending(coupler_);
    for (const auto& [other, slice] : plan_)
      if (const auto values = cut_out(data, list, interface_.dim, slice, name_); !values.empty())
        sending.add(other, output_tag, values);
    sending.wait("the coupler to receive values");
  }

 private:
  MPI_Comm coupler_, comm_;
  std::string name_;
  Interface interface_;  // only takes and gives
  Partition mine_;
  std::vector<Exchanged> plan_;
};

}  // namespace

Reply carry_out(const Command& command, Participant& participant, const std::string& name, MPI_Comm comm) {
  const auto start = std::chrono::steady_clock::now();
  Reply reply;
  try {
    dispatch(command, participant, name, comm, reply);
  } catch (const SolveFailure& failure) {
    reply = Reply{};
    reply.status =
        dynamic_cast<const SchemeFailure*>(&failure) ? Reply::Status::hopeless : Reply::Status::failure;
    reply.text = failure.what();
  }
  reply.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return reply;
}

void serve(MPI_Comm coupler, MPI_Comm comm, const std::string& name, Participant& participant,
           const ServeObserver& observer) {
  const bool root = parallel::comm_rank(comm) == 0;
  SubStepping stepping(participant);
  Ranks ranks(coupler, comm, name);
  for (;;) {
    observer.waiting();
    std::vector<char> head;
    if (root) head = receive_bytes(coupler, 0, command_tag, "");
    broadcast_bytes(comm, head, "");
    Command command = unpack_command(head);
    if (command.op == Op::initialise) stepping.set(command.step.sub_steps);
    ranks.receive(command.data);
    observer.received(command);
    Reply reply = carry_out(command, stepping, name, comm);
    if (command.op == Op::finalise) reply.text = observer.last_word();
    observer.done(command);
    if (command.op == Op::accept_step) observer.accepted(command, reply.report);
    const bool described = reply.status == Reply::Status::ok && command.op == Op::initialise;
    Partition cut = described ? cut_of(comm, reply.interface) : Partition{};
    if (root)
      head = pack(reply, cut), send_bytes(coupler, 0, reply_tag, head,
                                          "the coupler to receive a "
                                          "reply");
    if (described) {
      // If rank 0 describes everything, the other ranks take its description.
      broadcast_bytes(comm, head, "");
      ranks.send_places(reply.interface, unpack_reply(head, cut).interface, cut);
    }
    if (reply.status == Reply::Status::ok && command.op == Op::solve) ranks.send(reply.data);
    if (command.op == Op::finalise) return;
  }
}

}  // namespace couplet::coupling
