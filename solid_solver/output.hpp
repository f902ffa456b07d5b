// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/io/field_writer.hpp"
#include "common/io/probe.hpp"
#include "common/io/series.hpp"
#include "solid_solver/solid.hpp"

namespace couplet {

/// The files of a solid: fields, probes.csv, reactions.csv, solver.csv. They are opened when first written
/// to.
class SolidOutput {
 public:
  SolidOutput(const Solid& solid, const SolidContext& context);

  /// `points`: displacement of all local points.
  void write_fields(double time, std::span<const double> points);
  void write_series(double time, std::span<const double> points);

 private:
  void write_probes(double time, std::span<const double> points);
  void write_reactions(double time, std::span<const double> points);
  void write_effort(double time);

  const Solid& solid_;
  const SolidContext& context_;
  std::vector<Probe> probes_;
  std::optional<FieldWriter> fields_;
  std::optional<Series> probe_series_, reaction_series_, solver_series_;  // on rank 0
};

}  // namespace couplet
