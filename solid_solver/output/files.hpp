// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <filesystem>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/io/fields/mesh_part.hpp"
#include "common/io/series.hpp"
#include "common/parallel/collective.hpp"
#include "solid_solver/body/stress.hpp"

namespace couplet::solid {

/// Name, output folder and restart time of a solid.
struct SolidContext {
  std::string name = "solid";
  std::filesystem::path output_folder;  ///< empty if nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  io::FieldChoice fields{};
};

/// Tables of a run, each opened for its first row. Only rank 0 writes.
class SeriesFiles {
 public:
  /// Keeps a reference.
  SeriesFiles(const SolidContext& context, MPI_Comm comm)
      : context_(context), writes_(parallel::comm_rank(comm) == 0) {}
  void add(const std::string& file, const std::vector<std::string>& columns, std::span<const double> row) {
    if (!writes_) return;
    const auto at = list_.try_emplace(file, context_.output_folder / file, columns, context_.restart_time);
    at.first->second.row(row);
  }

 private:
  const SolidContext& context_;
  bool writes_;
  std::map<std::string, io::Series> list_;
};

/// Fields and their values.
class FieldList {
 public:
  void add(std::string name, const char* unit, io::OutputField::Place place, int components,
           std::vector<double> values) {
    values_.push_back(std::move(values));
    list.push_back({std::move(name), unit, place, components, values_.back()});
  }
  /// Adds one field per component, in 2-D without out-of-plane shear. `packed`: tensor after tensor.
  void add_tensor(const std::string& name, const char* unit, io::OutputField::Place place, int dim,
                  std::span<const double> packed) {
    for (std::size_t i = 0; i < (dim == 2 ? 4 : tensor_size); ++i) {
      std::vector<double> values(packed.size() / tensor_size);
      for (std::size_t e = 0; e < values.size(); ++e) values[e] = packed[e * tensor_size + i];
      add(name + "-" + tensor_component[i], unit, place, 1, std::move(values));
    }
  }
  std::vector<io::OutputField> list;

 private:
  std::deque<std::vector<double>> values_;
};

}  // namespace couplet::solid
