// SPDX-License-Identifier: Apache-2.0
#include "common/io/checkpoint.hpp"

#include <unistd.h>

#include <algorithm>
#include <optional>

#include "common/base/own_file.hpp"
#include "common/io/checkpoint_format.hpp"
#include "common/io/checkpoint_set.hpp"
#include "common/io/hdf5.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

struct CheckpointWriter::WriterState {
  MPI_Comm comm;
  std::filesystem::path file, part;
  hdf5::Handle id;
  std::optional<mesh::OrderOfEntries> orders;

  void require_new(const std::string& path, const std::string& name) const {
    if (hdf5::exists(id, path))
      throw Error("The checkpoint '{}' received the array '{}' twice.", file.string(), name);
  }

  void write_array(const std::string& name, std::span<const double> values) const {
    require_new(array_path(name), name);
    const hdf5::RowSpan rows = hdf5::distribute_rows(comm, values.size(), 1);
    hdf5::write_table(id, array_path(name), rows, values.data());
    const auto count = static_cast<std::int64_t>(values.size());
    hdf5::write_table(id, layout_path(name), hdf5::distribute_rows(comm, 1, 1), &count);
  }

  /// Stores entries of this rank that the file would not restore.
  void write_copies(const parallel::GlobalOrder& order, const std::string& name,
                    std::span<const double> values, std::span<const double> block, std::size_t width) const {
    const std::vector<double> back = order.from_block(block, width);
    std::vector<double> copies;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::bit_cast<std::uint64_t>(values[i]) != std::bit_cast<std::uint64_t>(back[i]))
        copies.insert(copies.end(), {double(i), values[i]});
    if (parallel::any(comm, !copies.empty())) write_array(copies_of(name), copies);
  }

  void write_field(const parallel::GlobalOrder& order, const std::string& name,
                   std::span<const double> values) const {
    require_new(field_path(name), name);
    const std::size_t n = order.n_local();
    const bool odd = n == 0 ? !values.empty() : values.size() % n != 0;
    const auto width = static_cast<std::size_t>(parallel::max(comm, n == 0 ? 0. : double(values.size() / n)));
    if (parallel::any(comm, odd || values.size() != n * width))
      throw Error("The checkpoint '{}' received {} values of '{}' for {} entries.", file.string(),
                  values.size(), name, n);
    const std::vector<double> block = order.to_block(values, width);
    const auto rows = width == 0 ? 0 : std::uint64_t(order.n_global());
    const auto first = std::uint64_t(order.first());
    hdf5::write_table(
        id, field_path(name),
        {rows == 0 ? 0 : first, rows == 0 ? 0 : order.count(), rows, std::max<std::size_t>(width, 1)},
        block.data());
    const std::int64_t check[2] = {std::int64_t(rows), std::int64_t(width)};
    const bool root = parallel::comm_rank(comm) == 0;
    hdf5::write_table(id, check_path(name), hdf5::distribute_rows(comm, root ? 1 : 0, 2), check);
    if (parallel::comm_size(comm) > 1 && width > 0) write_copies(order, name, values, block, width);
  }
};

CheckpointWriter::CheckpointWriter(MPI_Comm comm, const std::filesystem::path& file)
    : state_(std::make_unique<WriterState>()) {
  state_->comm = comm;
  state_->file = file;
  state_->part = file.string() + ".part";
  parallel::on_root(comm, [&] {
    std::error_code code;
    const std::filesystem::path folder = folder_of(file);
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
      throw Error("Cannot create the folder '{}' for the checkpoint '{}' ({}).", folder.string(),
                  file.string(), code.message());
    if (::access(folder.c_str(), W_OK) != 0)
      throw Error("Cannot write to the folder '{}' of the checkpoint '{}'.", folder.string(), file.string());
  });
  std::string stamp = parallel::comm_rank(comm) == 0 ? stamp_being_written(folder_of(file)) : "";
  if (stamp.empty()) stamp = "alone";
  parallel::broadcast(comm, stamp);
  state_->id = hdf5::create_file(comm, state_->part);
  hdf5::write_attribute(state_->id, "format", std::string(checkpoint_format));
  hdf5::write_attribute(state_->id, "version", double(checkpoint_version));
  hdf5::write_attribute(state_->id, "ranks", double(parallel::comm_size(comm)));
  hdf5::write_attribute(state_->id, "set", stamp);
}

CheckpointWriter::CheckpointWriter(StateInMemory& memory) : memory_(&memory) {}

CheckpointWriter::~CheckpointWriter() {
  if (memory_ || state_->id < 0) return;
  state_->id.reset();
  std::error_code ignored;
  if (parallel::comm_rank(state_->comm) == 0) std::filesystem::remove(state_->part, ignored);
}

MPI_Comm CheckpointWriter::comm() const { return memory_ ? MPI_COMM_SELF : state_->comm; }

void CheckpointWriter::on(const mesh::Mesh& mesh) {
  if (memory_) return;
  state_->orders.emplace(mesh);
  const auto identity = mesh::identity_of(mesh);
  const auto n = static_cast<std::size_t>(parallel::comm_rank(state_->comm) == 0);
  hdf5::write_table(state_->id, mesh_table, hdf5::distribute_rows(state_->comm, n, identity.size()),
                    identity.data());
  const auto share = std::bit_cast<std::int64_t>(mesh::share_of_rank(mesh));
  hdf5::write_table(state_->id, shares_table, hdf5::distribute_rows(state_->comm, 1, 1), &share);
}

void CheckpointWriter::write(const FieldEntries& entries, const std::string& name,
                             std::span<const double> values) {
  if (memory_)
    memory_->arrays_[name].assign(values.begin(), values.end());
  else
    state_->write_field(entries.order(state_->orders), name, values);
}

void CheckpointWriter::write(const std::string& name, std::span<const double> values) {
  if (memory_)
    memory_->arrays_[name].assign(values.begin(), values.end());
  else
    state_->write_array(name, values);
}

void CheckpointWriter::write_sums(const std::string& name, std::span<const double> values) {
  write(name, values);
}

void CheckpointWriter::write_common(const std::string& name, std::span<const double> values) {
  const bool counts = memory_ || parallel::comm_rank(state_->comm) == 0;
  write(name, counts ? values : std::span<const double>{});
}

void CheckpointWriter::close() {
  if (memory_ || state_->id < 0) return;
  hdf5::close_file(state_->comm, state_->id, state_->file);
  parallel::on_root(state_->comm, [&] {
    base::flush_to_disk(state_->part);
    std::error_code code;
    std::filesystem::rename(state_->part, state_->file, code);
    if (code)
      throw Error("Cannot rename the finished checkpoint to '{}' ({}).", state_->file.string(),
                  code.message());
    base::flush_to_disk(folder_of(state_->file));
  });
}

}  // namespace couplet::io
