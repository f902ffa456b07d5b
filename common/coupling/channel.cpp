// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/channel.hpp"

#include <algorithm>
#include <map>

#include "common/base/error.hpp"
#include "common/coupling/wait.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupling {

std::vector<Exchanged> exchanged(const Partition& mine, int rank, const Partition& theirs) {
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
  const std::string what = fmt::format("'{}' to take {}", name_, couplet::coupling::name(pending_));
  const int rank = parallel::comm_rank(comm_);
  if (rank == 0) send_bytes(peers_, 0, command_tag, pack(command), what);
  if (command.data.empty()) return;
  const auto data = present(command.data, takes_, name_);
  SendAll sending(peers_);
  for (const auto& [other, slice] : exchanged(mine_, rank, theirs_))
    if (const auto values = cut_out(command.data, data, dim_, slice, name_); !values.empty())
      sending.add(other, input_tag, values);
  sending.wait(what);
}

namespace {

/// Checks that the surface is distributed over the participant's ranks.
void check_cut(const Partition& cut, int ranks) {
  for (const Starts* starts : {&cut.vertices, &cut.faces})
    if (starts->size() != std::size_t(ranks) + 1)
      throw Error("it partitions its interface over {} ranks, but runs on {}", starts->size() - 1, ranks);
}

/// Checks that names in a list are unique.
void check_names(const std::vector<Interface::Datum>& list) {
  for (std::size_t i = 0; i < list.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (list[i].name == list[j].name) throw Error("it announces '{}' twice", list[i].name);
}

/// Compares received vertices and faces with the announced ones.
void check_places(const Interface& interface, const Partition& mine, int rank, const std::string& whose) {
  const auto here = [&](const Starts& starts) {
    return std::size_t(starts[std::size_t(rank) + 1] - starts[std::size_t(rank)]);
  };
  if (interface.vertices.size() != here(mine.vertices) || interface.face_centres.size() != here(mine.faces))
    throw Error("'{}' announced an interface of {} vertices and {} faces, but described {} and {}.", whose,
                here(mine.vertices), here(mine.faces), interface.vertices.size(),
                interface.face_centres.size());
  for (const Index v : interface.face_vertices)
    if (v >= mine.vertices.back())
      throw Error("A face of the interface of '{}' refers to vertex {} of {} (counted from 0).", whose, v,
                  mine.vertices.back());
}

}  // namespace

// Checks a guest's message before using it.
Reply MpiChannel::unpacked(const std::vector<char>& head, Partition& cut) const {
  try {
    Reply reply = unpack_reply(head, cut);
    if (pending_ != Op::initialise || reply.status != Reply::Status::ok) return reply;
    int ranks = 0;
    MPI_Comm_remote_size(peers_, &ranks);
    check_cut(cut, ranks);
    check_names(reply.interface.takes);
    check_names(reply.interface.gives);
    return reply;
  } catch (const Error& error) {
    throw Error("The reply of '{}' to {} is not valid: {} (format: docs/protocol.md)", name_,
                couplet::coupling::name(pending_), error.what());
  }
}

Reply MpiChannel::receive() {
  const std::string what = fmt::format("'{}' to answer {}", name_, couplet::coupling::name(pending_));
  std::vector<char> head;
  const double begun = processor_seconds();
  if (parallel::comm_rank(comm_) == 0) head = receive_bytes(peers_, 0, reply_tag, what, longest_head);
  broadcast_bytes(comm_, head, "");
  waiting_seconds_ += processor_seconds() - begun;
  Partition cut;
  Reply reply = unpacked(head, cut);
  if (reply.status != Reply::Status::ok) return reply;
  if (pending_ == Op::initialise) {
    theirs_ = std::move(cut);
    mine_ = {even_starts(theirs_.vertices.back(), parallel::comm_size(comm_)),
             even_starts(theirs_.faces.back(), parallel::comm_size(comm_))};
    dim_ = reply.interface.dim;
    takes_ = reply.interface.takes, gives_ = reply.interface.gives;
    receive_places(reply.interface, reply.surfaces);
  }
  if (pending_ == Op::solve || pending_ == Op::initialise) receive_values(reply.data);
  return reply;
}

void MpiChannel::receive_places(Interface& interface, Surfaces& surfaces) {
  for (const auto& [other, slice] : exchanged(mine_, parallel::comm_rank(comm_), theirs_))
    put_back(receive_bytes(peers_, other, places_tag, "the interface geometry of '" + name_ + "'"), interface,
             surfaces.of_vertex);
  check_places(interface, mine_, parallel::comm_rank(comm_), name_);
  if ((!surfaces.of_vertex.empty() || !surfaces.takes.empty() || !surfaces.gives.empty()) &&
      surfaces.of_vertex.size() != interface.vertices.size())
    throw Error("'{}' gave the surfaces of {} of the {} vertices of its interface.", name_,
                surfaces.of_vertex.size(), interface.vertices.size());
  if (interface.face_vertices.empty()) interface.face_offset.clear();  // unknown
}

void MpiChannel::receive_values(Exchange& data) {
  const int rank = parallel::comm_rank(comm_);
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

}  // namespace couplet::coupling
