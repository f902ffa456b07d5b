// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/channel.hpp"

#include <map>

#include "common/base/error.hpp"
#include "common/coupling/serve.hpp"
#include "common/coupling/sub_stepping.hpp"
#include "common/coupling/wait.hpp"
#include "common/parallel/collective.hpp"

namespace couplet {

std::vector<Exchanged> exchanged(const Cut& mine, int rank, const Cut& theirs) {
  std::map<int, Slice> by_rank;
  for (const Overlap& o : overlaps(mine.vertices, rank, theirs.vertices))
    by_rank[o.rank].first_vertex = o.first, by_rank[o.rank].vertices = o.count;
  for (const Overlap& o : overlaps(mine.faces, rank, theirs.faces))
    by_rank[o.rank].first_face = o.first, by_rank[o.rank].faces = o.count;
  std::vector<Exchanged> list;
  for (const auto& [other, slice] : by_rank) list.push_back({other, slice});
  return list;
}

void MpiChannel::send(const Command& command) {
  pending_ = command.op;
  const std::string what = fmt::format("'{}' to take {}", name_, couplet::name(pending_));
  const int rank = comm_rank(comm_);
  if (rank == 0) send_bytes(peers_, 0, command_tag, pack(command), what);
  if (command.op != Op::solve || command.data.empty()) return;
  const auto data = present(command.data, takes_, name_);
  SendAll sending(peers_);
  for (const auto& [other, slice] : exchanged(mine_, rank, theirs_))
    if (const auto values = cut_out(command.data, data, dim_, slice, name_); !values.empty())
      sending.add(other, input_tag, values);
  sending.wait(what);
}

Reply MpiChannel::receive() {
  const std::string what = fmt::format("'{}' to answer {}", name_, couplet::name(pending_));
  std::vector<char> head;
  const double begun = processor_seconds();
  if (comm_rank(comm_) == 0) head = receive_bytes(peers_, 0, reply_tag, what);
  broadcast_bytes(comm_, head, "");
  waiting_seconds_ += processor_seconds() - begun;
  Cut cut;
  Reply reply = unpack_reply(head, cut);
  if (reply.status != Reply::Status::ok) return reply;
  if (pending_ == Op::initialise) {
    theirs_ = std::move(cut);
    mine_ = {even_starts(theirs_.vertices.back(), comm_size(comm_)),
             even_starts(theirs_.faces.back(), comm_size(comm_))};
    dim_ = reply.interface.dim;
    takes_ = reply.interface.takes, gives_ = reply.interface.gives;
    receive_places(reply.interface);
  }
  if (pending_ == Op::solve) receive_values(reply.data);
  return reply;
}

void MpiChannel::receive_places(Interface& interface) {
  for (const auto& [other, slice] : exchanged(mine_, comm_rank(comm_), theirs_))
    put_back(receive_bytes(peers_, other, places_tag, "the places of '" + name_ + "'"), interface);
  if (interface.face_vertices.empty()) interface.face_offset.clear();  // not known
}

void MpiChannel::receive_values(Exchange& data) {
  const int rank = comm_rank(comm_);
  const auto list = present(data, gives_, name_);
  for (const auto& datum : list) {
    const Starts& starts = datum.place == Interface::Place::vertices ? mine_.vertices : mine_.faces;
    std::vector<double>& values = data[datum.name];
    if (const auto old = spare_.find(datum.name); old != spare_.end()) values = std::move(old->second);
    values.resize(std::size_t(starts[std::size_t(rank) + 1] - starts[std::size_t(rank)]) *
                  std::size_t(datum.size(dim_)));
  }
  spare_.clear();
  for (const auto& [other, slice] : exchanged(mine_, rank, theirs_))
    if (const auto to = places_in(data, list, dim_, slice, name_); !to.empty())
      receive_stretches(peers_, other, output_tag, to, "values of '" + name_ + "'");
}

LocalChannel::LocalChannel(std::string name, Participant& participant, MPI_Comm comm)
    : name_(std::move(name)), participant_(std::make_unique<SubStepping>(participant)), comm_(comm) {}
LocalChannel::~LocalChannel() = default;

void LocalChannel::send(const Command& command) {
  if (command.op == Op::initialise) participant_->set(command.step.sub_steps);
  const double begun = processor_seconds();
  reply_ = carry_out(command, *participant_, name_, comm_);
  waiting_seconds_ += processor_seconds() - begun;
}

}  // namespace couplet
