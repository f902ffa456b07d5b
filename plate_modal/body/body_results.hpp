// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/io/series.hpp"
#include "plate_modal/body/rigid_body.hpp"

namespace couplet::plate {

/// Writes the files of a rigid body: body.csv, energies.csv, probes.csv and, in three dimensions, the moving surface. Without an output
/// folder there are none.
class BodyResults final {
 public:
  explicit BodyResults(const RigidBody& body);

  void write_start() const;
  void write_fields(double time);
  void write_series(double time);

 private:
  void row(std::optional<io::Series>& one, const char* file, const std::vector<std::string>& columns,
           const std::vector<double>& values);

  const RigidBody& body_;
  bool active_, root_;
  mesh::Mesh surface_;  // of a body in three dimensions
  std::optional<io::FieldWriter> fields_;
  std::optional<io::Series> motion_, energies_, probes_;
};

}  // namespace couplet::plate
