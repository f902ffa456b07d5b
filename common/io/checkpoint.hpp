// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mpi.h>

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

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

/// One participant's state at an accepted time, one HDF5 file. Arrays are written rank by rank as they are
/// (bit for bit on equal ranks). Written under a temporary name, flushed and renamed in close(), so the last
/// good file is never lost.
class CheckpointWriter {
 public:
  CheckpointWriter(MPI_Comm comm, const std::filesystem::path& file);
  /// No file: into memory.
  explicit CheckpointWriter(StateInMemory& memory);
  ~CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;
  /// Collective: every rank writes its own part.
  void write(const std::string& name, std::span<const double> values);
  /// The same on all ranks (rank 0's counts).
  void write_scalar(const std::string& name, double value);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
  StateInMemory* memory_ = nullptr;
};

/// What --check can say of a checkpoint: what CheckpointReader refuses on any number of ranks. Empty: nothing.
std::string problem_of_checkpoint(const std::filesystem::path& file);

/// Throws Error naming the file and what is wrong: missing, truncated, not a checkpoint, other number of
/// ranks, missing array or another size than expected.
class CheckpointReader {
 public:
  CheckpointReader(MPI_Comm comm, const std::filesystem::path& file);
  explicit CheckpointReader(const StateInMemory& memory);
  ~CheckpointReader();
  CheckpointReader(const CheckpointReader&) = delete;
  /// Fills `values`, whose size must be what this rank wrote.
  void read(const std::string& name, std::span<double> values);
  /// As many values as this rank wrote.
  std::vector<double> read(const std::string& name);
  /// The same, of which there must be `n` or none on this rank.
  std::vector<double> read_or_none(const std::string& name, std::size_t n);
  double read_scalar(const std::string& name);
  /// A whole number from 0 to `most`.
  std::size_t read_count(const std::string& name, std::size_t most);

 private:
  struct State;
  std::unique_ptr<State> state_;
  const std::vector<double>& in_memory(const std::string& name) const;
  const StateInMemory* memory_ = nullptr;
};

}  // namespace couplet::io
