// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "fluid_solver/output/samples.hpp"
#include "fluid_solver/output/series.hpp"
#include "fluid_solver/output/statistics.hpp"
#include "fluid_solver/output/surfaces.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// Where a fluid writes to.
struct FluidContext {
  std::string name = "fluid";
  std::filesystem::path output_folder;  ///< empty: nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  io::FieldChoice fields{};
};

/// The files of a fluid: fields, forces.csv, coefficients.csv, walls.csv, fluxes.csv, flow-areas.csv, balance.csv, energy.csv,
/// bodies.csv, probes.csv, sample-NAME.csv, surface-PATCH.h5. They are opened when first written to.
template <int D>
class FluidOutput {
 public:
  /// `geometry`: of the mesh at rest, looked at while this is made.
  FluidOutput(const Fluid<D>& fluid, const mesh::Geometry& geometry, FluidContext context);
  FluidOutput(const FluidOutput&) = delete;  // its tables look at it
  /// Where output `number` has fields in the volume. `statistics` may be null.
  void write_fields(double time, int number, const RunningStatistics<D>* statistics);
  void write_series(double time);
  /// Writes the patches that the case asks for. Collective.
  void write_surfaces(double time);
  /// Lines and planes. `statistics` may be null. Collective.
  void write_samples(double time, const RunningStatistics<D>* statistics);

 private:
  void set_up_points(const mesh::Geometry& geometry);
  void check_coefficients() const;
  Row probes();
  io::Series open(const std::string& file, const std::vector<std::string>& columns) const;

  const Fluid<D>& fluid_;
  const mesh::Mesh& mesh_;
  FluidContext context_;
  bool root_;
  std::vector<io::Probe> probes_;
  std::vector<Sample> samples_;
  std::optional<PointValues<D>> point_values_;  // only with probes or samples
  std::vector<const mesh::Patch*> walls_;
  std::optional<io::FieldWriter> fields_;
  std::optional<FluidSurfaces<D>> surfaces_;
  std::vector<SeriesTable> tables_;
  std::vector<std::optional<io::Series>> sample_series_;  // one a sample, on rank 0
};

}  // namespace couplet::fluid
