// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/numbers.hpp"
#include "common/io/checkpoint.hpp"

namespace couplet::io {

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
  /// `width` values per entry, or none at all. `order`: mesh::Entries of the mesh that the file is on, or a
  /// parallel::GlobalOrder.
  template <class Order>
  void field(const Order& order, const std::string& name, std::vector<double>& values, std::size_t width) {
    if (out_)
      out_->write(order, prefix_ + name, values);
    else
      values = in_->read_or_none(order, prefix_ + name, width);
  }

 private:
  CheckpointWriter* out_ = nullptr;
  CheckpointReader* in_ = nullptr;
  std::string prefix_;
};

}  // namespace couplet::io
