// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/io/series.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {

/// Place on the surface: the corners of its face and their weights.
struct SurfacePlace {
  std::vector<Index> vertices;
  std::vector<double> weights;
  double distance = 0;  ///< from the requested place [m]
};
/// Nearest place of a surface, with linear weights in triangles (a quadrilateral is split into two).
SurfacePlace nearest_place(const modes::ModalModel& model, const Vec3& point);

/// Writes the files of a structure: frequencies.csv, modal.csv, energies.csv, contact.csv, probes.csv, the
/// moving surface and the mode shapes. Each is opened on first use; without an output folder there are none.
class PlateResults final {
 public:
  explicit PlateResults(const Structure& structure);

  void write_start();
  void write_fields(double time);
  void write_series(double time);
  /// Adds frequencies and the largest displacement to the results of the run.
  void log() const;

 private:
  std::vector<Vec3> places() const;  // of the vertices, on rank 0
  void write_frequencies();
  void write_shapes();
  void write_contact(double time);
  void write_energies(double time);
  io::Series& series(std::optional<io::Series>& one, const char* file,
                     const std::vector<std::string>& columns);

  const Structure& structure_;
  bool active_, root_;
  mesh::Mesh surface_;  // the whole surface on rank 0; its points are the vertices of the model
  std::vector<SurfacePlace> probes_;
  std::optional<io::FieldWriter> fields_;
  std::optional<io::Series> modal_, energies_, contact_, probe_series_, static_;
};

}  // namespace couplet::plate
