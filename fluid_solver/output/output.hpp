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

/// Values at mesh points from those in cells and at the boundary of the current mesh, for probes and samples.
template <int D>
class PointValues {
 public:
  /// `geometry`: geometry of the mesh at rest, used only in the constructor.
  PointValues(const Fluid<D>& fluid, const mesh::Geometry& geometry);
  /// Call when the mesh may have moved, before fill(). Collective.
  void follow();
  /// Sets `values`, width() per local point, at the points of the probes only. Collective.
  void fill(const FlowQuantities<D>& quantities, std::span<const io::Probe> probes,
            std::span<double> values) const;

 private:
  const Fluid<D>& fluid_;
  fv::VertexInterpolation interpolation_;
};

/// Places of a line or plane that lie in the mesh.
class Profile {
 public:
  /// `places`: local points [m]. Throws Error if no place of the sample is in the mesh. Collective.
  Profile(const mesh::Mesh& mesh, std::span<const Vec3> places, std::string name,
          const SampleParameters& parameters);
  const std::string& name() const { return name_; }
  const std::vector<io::Probe>& probes() const { return probes_; }
  /// Position of each probe along from-to and from-up, 0 to 1.
  const std::vector<std::array<double, 2>>& along() const { return along_; }
  /// Values at each probe from those at local points, `components` each, on rank 0, else empty. Collective.
  std::vector<double> gather(MPI_Comm comm, std::span<const double> at_points, int components) const;

 private:
  std::string name_;
  std::vector<io::Probe> probes_;
  std::vector<std::array<double, 2>> along_;
};

struct FluidContext;

/// Writes surface-<patch>.h5 for `output.surfaces`: pressure, traction, wall shear, y+ at walls, and Cp if a
/// section `coefficients` names the wall.
template <int D>
class FluidSurfaces {
 public:
  /// Keeps a reference. Throws Error for a name that is no patch. Collective.
  explicit FluidSurfaces(const Fluid<D>& fluid);
  /// Writes nothing before the first step, which computes the first load. Collective.
  void write(double time, const FluidContext& context);

 private:
  struct Faces;
  Faces faces() const;
  std::vector<double> pressure_coefficient(const mesh::Patch& patch, std::span<const double> pressure) const;

  const Fluid<D>& fluid_;
  io::SurfaceSeries series_;
  bool is_open_ = false;
};

/// Numbers at one time, each with its name and unit, for example "drag [-]".
using Row = std::vector<std::pair<std::string, double>>;

/// File with one row per step, opened with the first row.
struct SeriesTable {
  std::string file;
  std::function<Row()> row;  ///< collective, read on rank 0; empty if nothing is known yet
  std::optional<io::Series> series{};
};

/// Tables requested by the case, and balance.csv. `walls`: patches on which forces are computed.
template <int D>
std::vector<SeriesTable> tables_of(const Fluid<D>& fluid, const std::vector<const mesh::Patch*>& walls);

/// Name, output folder and restart time of a fluid.
struct FluidContext {
  std::string name = "fluid";
  std::filesystem::path output_folder;  ///< empty if nothing is written
  double restart_time = std::numeric_limits<double>::quiet_NaN();
  io::FieldChoice fields{};
  /// True if the structure obeys linear theory, so that pressures act along the normals of its undeformed surface.
  bool loads_at_rest = false;
};

/// Writes the files of a fluid: fields, forces.csv, coefficients.csv, walls.csv, fluxes.csv, flow-areas.csv,
/// balance.csv, energy.csv, bodies.csv, probes.csv, sample-NAME.csv, surface-PATCH.h5.
template <int D>
class FluidOutput {
 public:
  /// `geometry`: geometry of the mesh at rest, used only in the constructor.
  FluidOutput(const Fluid<D>& fluid, const mesh::Geometry& geometry, FluidContext context);
  FluidOutput(const FluidOutput&) = delete;  // its tables refer to it
  /// Writes the volume fields of output `number`, if it has any. `statistics` may be nullptr.
  void write_fields(double time, int number, const RunningStatistics<D>* statistics);
  void write_series(double time);
  /// Writes the patches requested by the case. Collective.
  void write_surfaces(double time);
  /// Writes lines and planes. `statistics` may be nullptr. Collective.
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
  std::vector<Profile> samples_;
  std::optional<PointValues<D>> point_values_;  // only with probes or samples
  std::vector<const mesh::Patch*> walls_;
  std::optional<io::FieldWriter> fields_;
  std::optional<FluidSurfaces<D>> surfaces_;
  std::vector<SeriesTable> tables_;
  std::vector<std::optional<io::Series>> sample_series_;  // one per sample, on rank 0
};

}  // namespace couplet::fluid
