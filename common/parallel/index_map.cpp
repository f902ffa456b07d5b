// SPDX-License-Identifier: Apache-2.0
#include "common/parallel/index_map.hpp"

#include <cassert>
#include <numeric>

#include "common/parallel/collective.hpp"

namespace couplet::parallel {

/// Who sends what to whom. Messages are packed rank by rank; both sides keep the same order.
struct IndexMap::Exchange {
  struct Peer {
    int rank;
    std::vector<Index> entries;
  };
  MPI_Comm comm = MPI_COMM_NULL;
  std::vector<Peer> owned_for;  // entries of mine that others hold as ghosts
  std::vector<Peer> ghosts_of;  // ghosts here that others own
  static constexpr int tag = 7001;

  template <class T, class Unpack>
  void run(const std::vector<Peer>& from, const std::vector<Peer>& to, std::span<const T> values,
           int components, MPI_Datatype type, Unpack&& unpack) const {
    std::vector<std::vector<T>> in(to.size()), out(from.size());
    std::vector<MPI_Request> requests;
    requests.reserve(to.size() + from.size());
    for (std::size_t p = 0; p < to.size(); ++p) {
      in[p].resize(to[p].entries.size() * components);
      MPI_Irecv(in[p].data(), static_cast<int>(in[p].size()), type, to[p].rank, tag, comm,
                &requests.emplace_back());
    }
    for (std::size_t p = 0; p < from.size(); ++p) {
      out[p].reserve(from[p].entries.size() * components);
      for (const Index e : from[p].entries) {
        const auto entry = values.subspan(std::size_t(e) * components, components);
        out[p].insert(out[p].end(), entry.begin(), entry.end());
      }
      MPI_Isend(out[p].data(), static_cast<int>(out[p].size()), type, from[p].rank, tag, comm,
                &requests.emplace_back());
    }
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    for (std::size_t p = 0; p < to.size(); ++p)
      for (std::size_t i = 0; i < to[p].entries.size(); ++i)
        for (int c = 0; c < components; ++c)
          unpack(std::size_t(to[p].entries[i]) * components + c, in[p][i * components + c]);
  }
};

IndexMap::IndexMap(MPI_Comm comm, Index n_owned, const std::vector<int>& ghost_owner,
                   const std::vector<Index>& ghost_remote)
    : n_owned_(n_owned), n_local_(n_owned + static_cast<Index>(ghost_owner.size())) {
  assert(ghost_owner.size() == ghost_remote.size());
  n_global_ = sum(comm, GlobalIndex(n_owned));
  first_ = exclusive_scan(comm, n_owned);
  global_.resize(n_local_);
  std::iota(global_.begin(), global_.begin() + n_owned, first_);

  const int size = comm_size(comm);
  std::vector<std::vector<Index>> wanted(size), ghosts(size);
  for (std::size_t g = 0; g < ghost_owner.size(); ++g) {
    wanted[ghost_owner[g]].push_back(ghost_remote[g]);
    ghosts[ghost_owner[g]].push_back(n_owned + static_cast<Index>(g));
  }
  const auto asked = all_to_all(comm, wanted);
  auto exchange = std::make_shared<Exchange>();
  exchange->comm = comm;
  for (int r = 0; r < size; ++r) {
    if (!asked[r].empty()) exchange->owned_for.push_back({r, asked[r]});
    if (!ghosts[r].empty()) exchange->ghosts_of.push_back({r, ghosts[r]});
  }
  exchange_ = exchange;
  update_ghosts(std::span<GlobalIndex>(global_));
}

void IndexMap::update_ghosts(std::span<double> values, int components) const {
  assert(values.size() == std::size_t(n_local_) * components);
  if (!exchange_) return;
  exchange_->run<double>(exchange_->owned_for, exchange_->ghosts_of, values, components, MPI_DOUBLE,
                         [&](std::size_t i, double v) { values[i] = v; });
}

void IndexMap::update_ghosts(std::span<GlobalIndex> values) const {
  if (!exchange_) return;
  exchange_->run<GlobalIndex>(exchange_->owned_for, exchange_->ghosts_of, values, 1, MPI_INT64_T,
                              [&](std::size_t i, GlobalIndex v) { values[i] = v; });
}

void IndexMap::update_ghosts(std::span<std::byte> values, std::size_t size) const {
  assert(values.size() == std::size_t(n_local_) * size);
  if (!exchange_) return;
  exchange_->run<std::byte>(exchange_->owned_for, exchange_->ghosts_of, values, static_cast<int>(size),
                            MPI_BYTE, [&](std::size_t i, std::byte v) { values[i] = v; });
}

void IndexMap::add_to_owners(std::span<double> values, int components) const {
  assert(values.size() == std::size_t(n_local_) * components);
  if (!exchange_) return;
  exchange_->run<double>(exchange_->ghosts_of, exchange_->owned_for, values, components, MPI_DOUBLE,
                         [&](std::size_t i, double v) { values[i] += v; });
}

}  // namespace couplet::parallel
