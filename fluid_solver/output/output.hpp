// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/fv/vertex_interpolation.hpp"
#include "common/io/fields/field_writer.hpp"
#include "common/io/fields/surface_series.hpp"
#include "common/io/probes/probe.hpp"
#include "common/io/series.hpp"
#include "fluid_solver/output/derived.hpp"
#include "fluid_solver/step/fluid.hpp"

namespace couplet::fluid {

/// Values at mesh points from those in the cells and at the boundary, on the mesh as it is: what probes and
/// samples are made of.
template <int D>
class PointValues {
 public:
  /// `geometry`: of the mesh at rest, looked at while this is made.
  PointValues(const Fluid<D>& fluid, const mesh::Geometry& geometry);
  /// To be called when the mesh may have moved, before fill(). Collective.
  void follow();
  /// Sets `values`, width() a local point, at the points of the probes; the others are left alone. Collective.
  void fill(const Quantities<D>& quantities, std::span<const io::Probe> probes,
            std::span<double> values) const;

 private:
  const Fluid<D>& fluid_;
  fv::VertexInterpolation interpolation_;
};

/// The places of a line or plane that lie in the mesh.
class Sample {
 public:
  /// `places`: of the local points [m]. Throws Error if none does. Collective.
  Sample(const mesh::Mesh& mesh, std::span<const Vec3> places, std::string name,
         const SampleParameters& parameters);
  const std::string& name() const { return name_; }
  const std::vector<io::Probe>& probes() const { return probes_; }
  /// Position of each probe along from-to and from-up, 0 to 1.
  const std::vector<std::array<double, 2>>& along() const { return along_; }
  /// Values at each probe from those at local points, `components` each, on rank 0; empty elsewhere. Collective.
  std::vector<double> gather(MPI_Comm comm, std::span<const double> at_points, int components) const;

 private:
  std::string name_;
  std::vector<io::Probe> probes_;
  std::vector<std::array<double, 2>> along_;
};

struct FluidContext;

/// surface-<patch>.h5 of the patches in `output.surfaces`: pressure, traction and wall shear, y+ at walls, Cp where a
/// section `coefficients` names the wall.
template <int D>
class FluidSurfaces {
 public:
  /// Keeps a reference. Throws Error for a name that is no patch. Collective.
  explicit FluidSurfaces(const Fluid<D>& fluid);
  /// Nothing before the first step, which alone gives a load. Collective.
  void write(double time, const FluidContext& context);

 private:
  struct Faces;
  Faces faces() const;
  std::vector<double> pressure_coefficient(const mesh::Patch& patch, std::span<const double> pressure) const;

  const Fluid<D>& fluid_;
  io::SurfaceSeries series_;
  bool is_open_ = false;
};

/// Numbers of one time, each with its name and unit, "drag [-]".
using Row = std::vector<std::pair<std::string, double>>;

/// A file with one row per step, opened with the first row.
struct SeriesTable {
  std::string file;
  std::function<Row()> row;  ///< collective, counts on rank 0; empty: nothing is known yet
  std::optional<io::Series> series{};
};

/// The tables that the case asks for, and balance.csv. `walls`: patches that bear a force.
template <int D>
std::vector<SeriesTable> tables_of(const Fluid<D>& fluid, const std::vector<const mesh::Patch*>& walls);

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
