// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/numbers.hpp"
#include "common/mesh/entries.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::io {

/// A state kept in memory, each rank its own part: what a checkpoint writer puts in, a reader gets out.
class StateInMemory {
 public:
  void clear() { arrays_.clear(); }

 private:
  friend class CheckpointWriter;
  friend class CheckpointReader;
  std::map<std::string, std::vector<double>> arrays_;
};

/// The entries that a field has values of: cells, points or faces of the mesh that the file is on, or others in an order of
/// their own, by reference.
class FieldEntries {
 public:
  FieldEntries(mesh::Entries entries) : entries_(entries) {}
  FieldEntries(const parallel::GlobalOrder& order) : order_(&order) {}
  const parallel::GlobalOrder& order(std::optional<mesh::OrderOfEntries>& of_mesh) const {
    return order_ ? *order_ : of_mesh.value().of(entries_);
  }

 private:
  mesh::Entries entries_ = mesh::Entries::cells;
  const parallel::GlobalOrder* order_ = nullptr;
};

/// One participant's state at an accepted time, one HDF5 file, which any number of ranks can read: fields stand in it by the
/// numbers of cells, points and faces. On equal ranks all comes back bit for bit. Written under a temporary name, flushed
/// and renamed in close(), so the last good file is never lost. All calls are collective.
class CheckpointWriter {
 public:
  CheckpointWriter(MPI_Comm comm, const std::filesystem::path& file);
  /// No file: into memory.
  explicit CheckpointWriter(StateInMemory& memory);
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;

  /// The mesh of the fields that follow; it must outlive the writer.
  void on(const mesh::Mesh& mesh);
  /// A field, a whole number of values per entry; empty (on all ranks): there is none. Where a rank's copy of an entry that
  /// another one owns differs from the owner's, it is kept for equal ranks.
  void write(const FieldEntries& entries, const std::string& name, std::span<const double> values);
  /// The same on all ranks (rank 0's counts).
  void write_common(const std::string& name, std::span<const double> values);
  void write_scalar(const std::string& name, double value);
  /// Each rank's part of sums over all.
  void write_sums(const std::string& name, std::span<const double> values);
  /// Each rank's own: another number of ranks is refused.
  void write(const std::string& name, std::span<const double> values);
  void close();
  /// Of those who write; a state in memory is each rank's own.
  MPI_Comm comm() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
  StateInMemory* memory_ = nullptr;
};

/// What --check can say of a checkpoint: what CheckpointReader refuses. Empty: nothing.
std::string problem_of_checkpoint(const std::filesystem::path& file);

/// Throws Error naming the file and what is wrong: missing, truncated, not a checkpoint, of another mesh, missing array or
/// another size than expected. Each rank reads its block of a field alone, then the values go to where they belong; all calls
/// are collective.
class CheckpointReader {
 public:
  CheckpointReader(MPI_Comm comm, const std::filesystem::path& file);
  explicit CheckpointReader(const StateInMemory& memory);
  ~CheckpointReader();
  CheckpointReader(const CheckpointReader&) = delete;

  /// The mesh of the fields that follow, which must be the one they were written on; it must outlive the reader.
  void on(const mesh::Mesh& mesh);
  /// Of those who read; a state in memory is each rank's own.
  MPI_Comm comm() const;
  /// Whether as many ranks wrote it as read it, each with the same part of the mesh.
  bool on_same_ranks() const;

  /// Fills `values`: there must be as many per entry.
  void read(const FieldEntries& entries, const std::string& name, std::span<double> values);
  /// As many values as were written per entry, maybe none.
  std::vector<double> read(const FieldEntries& entries, const std::string& name);
  /// `width` values per entry, or none at all.
  std::vector<double> read_or_none(const FieldEntries& entries, const std::string& name, std::size_t width);
  void read_common(const std::string& name, std::span<double> values);
  std::vector<double> read_common(const std::string& name);
  double read_scalar(const std::string& name);
  /// A whole number from 0 to `most`.
  std::size_t read_count(const std::string& name, std::size_t most);
  /// This rank's part on equal ranks; else all of it on rank 0, and zeros on the others.
  void read_sums(const std::string& name, std::span<double> values);
  /// What this rank wrote, of just that size. Throws Error if another number of ranks wrote it.
  void read(const std::string& name, std::span<double> values);
  /// As many values as this rank wrote.
  std::vector<double> read(const std::string& name);

 private:
  struct State;
  std::unique_ptr<State> state_;
  const std::vector<double>& in_memory(const std::string& name) const;
  /// Copies all of what was read. Throws Error if it is of another size.
  void fill(const std::string& name, std::span<double> values, const std::vector<double>& all) const;
  const StateInMemory* memory_ = nullptr;
};

/// Saves or loads a state by one list: what the list names is written to a checkpoint, or read from it into
/// the same variables. All calls are collective.
class Archive final {
 public:
  explicit Archive(CheckpointWriter& out) : out_(&out) {}
  explicit Archive(CheckpointReader& in) : in_(&in) {}

  bool reads() const { return in_ != nullptr; }
  /// Put before each name that follows, so that parts of a state may use the same names.
  void set_prefix(std::string prefix) { prefix_ = std::move(prefix); }

  /// Values that are the same on all ranks (see base::Numbers for their types).
  template <class... T>
  void common(const std::string& name, T&... values) {
    if (out_) {
      base::Numbers numbers;
      numbers(values...);
      out_->write_common(prefix_ + name, numbers.values());
    } else {
      const std::vector<double> saved = in_->read_common(prefix_ + name);
      base::Numbers numbers(saved, name.c_str());
      numbers(values...);
      numbers.finish();
    }
  }

  /// Each rank's part of sums over all ranks.
  void sums(const std::string& name, std::span<double> values) {
    if (out_)
      out_->write_sums(prefix_ + name, values);
    else
      in_->read_sums(prefix_ + name, values);
  }
  /// `width` values per entry, or none at all.
  void field(const FieldEntries& entries, const std::string& name, std::vector<double>& values,
             std::size_t width) {
    if (out_)
      out_->write(entries, prefix_ + name, values);
    else
      values = in_->read_or_none(entries, prefix_ + name, width);
  }

 private:
  CheckpointWriter* out_ = nullptr;
  CheckpointReader* in_ = nullptr;
  std::string prefix_;
};

}  // namespace couplet::io
