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

/// State kept in memory, each rank its own part. A checkpoint writer fills it and a reader reads it back.
class StateInMemory {
 public:
  void clear() { arrays_.clear(); }

 private:
  friend class CheckpointWriter;
  friend class CheckpointReader;
  std::map<std::string, std::vector<double>> arrays_;
};

/// Location of a field's values: cells, points or faces of the mesh, or entries in an order of their own,
/// which is held by reference.
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

/// State of one participant at an accepted time in one HDF5 file, readable by any number of ranks. Fields are
/// stored by mesh numbers. The same number of ranks restores them bit for bit. close() flushes and renames a
/// temporary file, so the last good file is never lost. All calls are collective.
class CheckpointWriter {
 public:
  CheckpointWriter(MPI_Comm comm, const std::filesystem::path& file);
  /// Writes to memory instead of a file.
  explicit CheckpointWriter(StateInMemory& memory);
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;

  /// Sets the mesh of the fields that follow. It must outlive the writer.
  void on(const mesh::Mesh& mesh);
  /// Writes a field with a whole number of values per entry. It may be empty on all ranks. A ghost value that
  /// differs from its owner's value is kept for the same number of ranks.
  void write(const FieldEntries& entries, const std::string& name, std::span<const double> values);
  /// Writes values that are the same on all ranks (those of rank 0).
  void write_common(const std::string& name, std::span<const double> values);
  /// Writes this rank's contribution to sums over all ranks.
  void write_sums(const std::string& name, std::span<const double> values);
  /// Writes values of this rank. They can only be read by the same number of ranks.
  void write(const std::string& name, std::span<const double> values);
  void close();
  /// Communicator of the writing ranks. A checkpoint in memory belongs to one rank, whose communicator is MPI_COMM_SELF.
  MPI_Comm comm() const;

 private:
  struct WriterState;
  std::unique_ptr<WriterState> state_;
  StateInMemory* memory_ = nullptr;
};

/// Reason why CheckpointReader would reject the file, for --check. Empty if it is valid.
std::string problem_of_checkpoint(const std::filesystem::path& file);

/// Reads a checkpoint. Throws Error with the file and the reason if it is missing, truncated, not a
/// checkpoint or of another mesh, or if an array is missing or has another size. Each rank reads its block of
/// a field, then the values are sent to their ranks. All calls are collective.
class CheckpointReader {
 public:
  CheckpointReader(MPI_Comm comm, const std::filesystem::path& file);
  explicit CheckpointReader(const StateInMemory& memory);
  ~CheckpointReader();
  CheckpointReader(const CheckpointReader&) = delete;

  /// Sets the mesh on which the following fields were written. It must outlive the reader.
  void on(const mesh::Mesh& mesh);
  /// Communicator of the reading ranks. A checkpoint in memory belongs to one rank, whose communicator is MPI_COMM_SELF.
  MPI_Comm comm() const;
  /// Returns true if as many ranks wrote the file as read it, each with the same part of the mesh.
  bool on_same_ranks() const;

  /// Fills `values`, which must have the size of the saved field.
  void read(const FieldEntries& entries, const std::string& name, std::span<double> values);
  /// Returns as many values per entry as were written, possibly none.
  std::vector<double> read(const FieldEntries& entries, const std::string& name);
  /// Returns `width` values per entry, or none at all.
  std::vector<double> read_or_none(const FieldEntries& entries, const std::string& name, std::size_t width);
  void read_common(const std::string& name, std::span<double> values);
  std::vector<double> read_common(const std::string& name);
  /// Reads this rank's contribution. On another number of ranks, rank 0 gets the sum, the others zeros.
  void read_sums(const std::string& name, std::span<double> values);
  /// Reads the values this rank wrote. Throws Error for another size or another number of ranks.
  void read(const std::string& name, std::span<double> values);
  /// Reads all values that this rank wrote.
  std::vector<double> read(const std::string& name);

 private:
  struct ReaderState;
  std::unique_ptr<ReaderState> state_;
  const std::vector<double>& in_memory(const std::string& name) const;
  /// Copies `all` to `values`. Throws Error if the sizes differ.
  void fill(const std::string& name, std::span<double> values, const std::vector<double>& all) const;
  const StateInMemory* memory_ = nullptr;
};

/// Saves or loads a state by one list of variables, which is either written to a checkpoint or read from it.
/// All calls are collective.
class Archive final {
 public:
  explicit Archive(CheckpointWriter& out) : out_(&out) {}
  explicit Archive(CheckpointReader& in) : in_(&in) {}

  bool reads() const { return in_ != nullptr; }
  MPI_Comm comm() const { return out_ ? out_->comm() : in_->comm(); }
  /// Sets a prefix for the names that follow, so that parts of a state may use the same names.
  void set_prefix(std::string prefix) { prefix_ = std::move(prefix); }

  /// Archives values that are the same on all ranks (see base::Numbers for their types).
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

  /// Archives each rank's contribution to sums over all ranks.
  void sums(const std::string& name, std::span<double> values) {
    if (out_)
      out_->write_sums(prefix_ + name, values);
    else
      in_->read_sums(prefix_ + name, values);
  }
  /// Archives a field with `width` values per entry, or none at all.
  void field(const FieldEntries& entries, const std::string& name, std::vector<double>& values,
             std::size_t width) {
    if (out_)
      out_->write(entries, prefix_ + name, values);
    else
      values = in_->read_or_none(entries, prefix_ + name, width);
  }
  /// Archives a field of known size.
  void field(const FieldEntries& entries, const std::string& name, std::span<double> values) {
    if (out_)
      out_->write(entries, prefix_ + name, values);
    else
      in_->read(entries, prefix_ + name, values);
  }

 private:
  CheckpointWriter* out_ = nullptr;
  CheckpointReader* in_ = nullptr;
  std::string prefix_;
};

}  // namespace couplet::io
