// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "common/base/error.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_format.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

struct CheckpointReader::State {
  MPI_Comm comm;
  hdf5::Reader in;
  int ranks = 0;            // that wrote it
  bool same_share = false;  // of the mesh, on all ranks; of a state without a mesh: as many ranks
  std::optional<mesh::OrderOfEntries> orders{};

  /// What `read` throws on some rank is thrown on all.
  template <class Read>
  auto together(Read read) const {
    std::string trouble;
    decltype(read()) result{};
    try {
      result = read();
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
    return result;
  }

  [[noreturn]] void missing(const std::string& name) const {
    throw Error("The checkpoint '{}' has no array '{}'. It was written by another program or another case.",
                in.file().string(), name);
  }

  [[noreturn]] void corrupted(const std::string& name, const std::string& where) const {
    throw Error(
        "The checkpoint '{}' is corrupted: wrong checksum of the array '{}'{}. Use an earlier "
        "checkpoint.",
        in.file().string(), name, where);
  }

  /// What rank `from` wrote, read by this rank.
  std::vector<double> array_of(const std::string& name, int from) const {
    return together([&] {
      if (!in.has(array_path(name)) || !in.has(layout_path(name))) missing(name);
      const std::vector<std::int64_t> layout = layout_of_array(in, name, ranks);
      hdf5::Rows rows;
      for (int r = 0; r < ranks; ++r) {
        if (r < from) rows.first += std::uint64_t(layout[2 * r]);
        rows.total += std::uint64_t(layout[2 * r]);
      }
      rows.count = std::uint64_t(layout[2 * from]);
      std::vector<double> values(rows.count);
      in.read(array_path(name), rows, values.data());
      if (checksum(values) != layout[2 * from + 1]) corrupted(name, fmt::format(" on rank {}", from));
      return values;
    });
  }

  std::vector<double> own_array(const std::string& name) const {
    const int size = parallel::comm_size(comm);
    if (ranks != size && in.has(array_path(name)))
      throw Error(
          "The checkpoint '{}' was written on {} {}, this run has {}: its array '{}' is each rank's own. "
          "Restart on the same number of ranks.",
          in.file().string(), ranks, ranks == 1 ? "rank" : "ranks", size, name);
    return array_of(name, parallel::comm_rank(comm));
  }

  /// What a rank had in place of what the owner has.
  void put_copies(const std::string& name, std::vector<double>& values) const {
    if (!same_share || ranks == 1 || !in.has(array_path(copies_of(name)))) return;
    const std::vector<double> copies = own_array(copies_of(name));
    together([&] {
      for (std::size_t i = 0; i + 1 < copies.size(); i += 2) {
        if (!(copies[i] >= 0 && copies[i] < double(values.size())))
          in.refuse(fmt::format("the field '{}' has a copy of value {}", name, copies[i]));
        values[std::size_t(copies[i])] = copies[i + 1];
      }
      return 0;
    });
  }

  std::vector<double> field(const parallel::GlobalOrder& order, const std::string& name) const {
    const FieldCheck check = together([&] {
      if (!in.has(field_path(name)) || !in.has(check_path(name))) missing(name);
      const FieldCheck found = check_of_field(in, name);
      if (found.rows > 0 && found.rows != std::uint64_t(order.n_global()))
        throw Error(
            "The checkpoint '{}' has '{}' of {} entries, but {} are expected. Is it from the same mesh?",
            in.file().string(), name, found.rows, order.n_global());
      return found;
    });
    if (check.rows == 0) return {};
    const auto first = std::uint64_t(order.first());
    const std::vector<double> block = together([&] {
      std::vector<double> rows(order.count() * check.width);
      if (!rows.empty())
        in.read(field_path(name), {first, order.count(), check.rows, check.width}, rows.data());
      return rows;
    });
    std::uint64_t sum = part_of_checksum(block, first * check.width);
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, comm);
    if (std::bit_cast<std::int64_t>(sum) != check.checksum) corrupted(name, "");
    std::vector<double> values = order.from_block(block, check.width);
    put_copies(name, values);
    return values;
  }

  void require(const std::string& name, std::size_t found, std::size_t wanted) const {
    hdf5::throw_together(
        comm, found == wanted
                  ? ""
                  : fmt::format("The checkpoint '{}' has {} values of '{}' on rank {}, but {} are expected. "
                                "Is it from the same mesh?",
                                in.file().string(), found, name, parallel::comm_rank(comm), wanted));
  }

  std::vector<double> common(const std::string& name) const { return array_of(name, 0); }
};

CheckpointReader::CheckpointReader(MPI_Comm comm, const std::filesystem::path& file) {
  std::string trouble;
  const auto attempt = [&](auto&& act) {
    try {
      act();
    } catch (const Error& error) {
      trouble = error.what();
    }
    hdf5::throw_together(comm, trouble);
  };
  attempt([&] {
    if (parallel::comm_rank(comm) == 0) examine_checkpoint(file);
  });
  attempt([&] {
    state_ = std::make_unique<State>(State{comm, open_checkpoint(file)});
    state_->ranks = ranks_that_wrote(state_->in);
    state_->same_share = state_->ranks == parallel::comm_size(comm);
  });
}

// The file was opened by this rank alone, so closing it is local.
CheckpointReader::~CheckpointReader() = default;

CheckpointReader::CheckpointReader(const StateInMemory& memory) : memory_(&memory) {}

MPI_Comm CheckpointReader::comm() const { return memory_ ? MPI_COMM_SELF : state_->comm; }

void CheckpointReader::on(const mesh::Mesh& mesh) {
  if (memory_) return;
  const auto now = mesh::identity_of(mesh);
  const auto share = std::bit_cast<std::int64_t>(mesh::share_of_rank(mesh));
  const bool same = state_->together([&] {
    const hdf5::Reader& in = state_->in;
    auto then = now;
    if (!in.has(mesh_table)) in.refuse("it holds no mesh: it was written by another program or another case");
    in.read(mesh_table, {0, 1, 1, then.size()}, then.data());
    if (then != now)
      throw Error(
          "The checkpoint '{}' is from another mesh, of {} cells, {} points and {} boundary faces; this one "
          "has {}, {} and {}{}. Another version of gmsh may number them otherwise; give the same mesh file.",
          in.file().string(), then[0], then[1], then[2], now[0], now[1], now[2],
          std::equal(then.begin(), then.begin() + 3, now.begin()) ? ", in another order" : "");
    if (!state_->same_share) return false;
    std::int64_t before = 0;
    in.read(shares_table,
            {std::uint64_t(parallel::comm_rank(state_->comm)), 1, std::uint64_t(state_->ranks), 1}, &before);
    return before == share;
  });
  state_->same_share = !parallel::any(state_->comm, !same);
  state_->orders.emplace(mesh);
}

bool CheckpointReader::on_same_ranks() const { return memory_ || state_->same_share; }

const std::vector<double>& CheckpointReader::in_memory(const std::string& name) const {
  const auto found = memory_->arrays_.find(name);
  if (found == memory_->arrays_.end()) throw Error("The saved state has no '{}'.", name);
  return found->second;
}

void CheckpointReader::fill_from_memory(const std::string& name, std::span<double> values) const {
  const std::vector<double>& kept = in_memory(name);
  if (kept.size() != values.size())
    throw Error("The saved state has {} values of '{}', but {} are expected.", kept.size(), name,
                values.size());
  std::copy(kept.begin(), kept.end(), values.begin());
}

std::vector<double> CheckpointReader::read(mesh::Entries entries, const std::string& name) {
  if (memory_) return in_memory(name);
  return state_->field(state_->orders.value().of(entries), name);
}

std::vector<double> CheckpointReader::read(const parallel::GlobalOrder& order, const std::string& name) {
  return memory_ ? in_memory(name) : state_->field(order, name);
}

void CheckpointReader::read(mesh::Entries entries, const std::string& name, std::span<double> values) {
  if (memory_) return fill_from_memory(name, values);
  const std::vector<double> all = read(entries, name);
  state_->require(name, all.size(), values.size());
  std::ranges::copy(all, values.begin());
}

void CheckpointReader::read(const parallel::GlobalOrder& order, const std::string& name,
                            std::span<double> values) {
  if (memory_) return fill_from_memory(name, values);
  const std::vector<double> all = state_->field(order, name);
  state_->require(name, all.size(), values.size());
  std::ranges::copy(all, values.begin());
}

std::vector<double> CheckpointReader::read_or_none(mesh::Entries entries, const std::string& name,
                                                   std::size_t width) {
  if (memory_) return in_memory(name);
  return read_or_none(state_->orders.value().of(entries), name, width);
}

std::vector<double> CheckpointReader::read_or_none(const parallel::GlobalOrder& order,
                                                   const std::string& name, std::size_t width) {
  if (memory_) return in_memory(name);
  std::vector<double> values = state_->field(order, name);
  const bool none = !parallel::any(state_->comm, !values.empty());
  if (!none) state_->require(name, values.size(), width * order.n_local());
  return values;
}

std::vector<double> CheckpointReader::read_common(const std::string& name) {
  return memory_ ? in_memory(name) : state_->common(name);
}

void CheckpointReader::read_common(const std::string& name, std::span<double> values) {
  if (memory_) return fill_from_memory(name, values);
  const std::vector<double> all = state_->common(name);
  state_->require(name, all.size(), values.size());
  std::ranges::copy(all, values.begin());
}

void CheckpointReader::read_sums(const std::string& name, std::span<double> values) {
  if (memory_) return fill_from_memory(name, values);
  if (state_->ranks == parallel::comm_size(state_->comm)) return read(name, values);
  std::ranges::fill(values, 0.);
  for (int from = 0; from < state_->ranks; ++from) {
    const std::vector<double> part = state_->array_of(name, from);
    state_->require(name, part.size(), values.size());
    for (std::size_t i = 0; i < part.size() && parallel::comm_rank(state_->comm) == 0; ++i)
      values[i] += part[i];
  }
}

void CheckpointReader::read(const std::string& name, std::span<double> values) {
  if (memory_) return fill_from_memory(name, values);
  const std::vector<double> own = state_->own_array(name);
  state_->require(name, own.size(), values.size());
  std::ranges::copy(own, values.begin());
}

std::vector<double> CheckpointReader::read(const std::string& name) {
  return memory_ ? in_memory(name) : state_->own_array(name);
}

std::size_t CheckpointReader::read_count(const std::string& name, std::size_t most) {
  const double value = read_scalar(name);
  if (!(value >= 0 && value <= double(most)) || value != std::floor(value))
    throw Error(
        "The {} gives {} as '{}'; expected a whole number from 0 to {}.",
        memory_ ? std::string("saved state") : fmt::format("checkpoint '{}'", state_->in.file().string()),
        value, name, most);
  return static_cast<std::size_t>(value);
}

double CheckpointReader::read_scalar(const std::string& name) {
  if (memory_) return in_memory(scalar_path(name)).front();
  return state_->together([&] {
    if (!state_->in.has(scalar_path(name)))
      throw Error("The checkpoint '{}' has no value '{}'. It was written by another program or another case.",
                  state_->in.file().string(), name);
    return scalar_on_file(state_->in, name);
  });
}

}  // namespace couplet::io
