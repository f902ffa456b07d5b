// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "coupler/output/interface_output.hpp"
#include "coupler/output/mechanics.hpp"
#include "coupler/output/monitor.hpp"
#include "coupler/output/watch_integrals.hpp"
#include "coupler/pass.hpp"

namespace couplet::coupler {

/// Output files of the coupler: tables, balances of forces and work, interface data.
class Record {
 public:
  Record(MPI_Comm comm, const CouplingParameters& parameters, const Pass& pass);
  /// Opens the files. `restart_time`: NaN for a fresh start.
  void open(const std::filesystem::path& folder, double end_time, double restart_time);
  /// Forces and work of the accepted step on both sides. Moves the walls. Collective.
  const std::vector<SideBalance>& balance();
  /// Records an accepted step. `output`: number of the output that is due, or -1.
  void accepted(double time, int output, VolumeLevel* level);

  Monitor& monitor() { return *monitor_; }
  const Mechanics& mechanics() const { return mechanics_; }
  const std::vector<SideBalance>& balances() const { return balances_; }
  void save(io::CheckpointWriter& file) const;
  void load(io::CheckpointReader& file);

 private:
  parallel::GlobalOrder order_of_wall(std::size_t i) const;
  void write_balance(double time);

  MPI_Comm comm_;
  const CouplingParameters& parameters_;
  const Pass& pass_;
  Mechanics mechanics_;
  std::vector<SideBalance> balances_;  // of the last accepted step
  std::optional<Monitor> monitor_;
  std::optional<InterfaceOutput> interface_output_;
  std::optional<WatchIntegrals> watched_;
};

}  // namespace couplet::coupler
