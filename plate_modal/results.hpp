// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/io/series.hpp"
#include "plate_modal/structure.hpp"

namespace couplet::plate {

/// A place of the surface: the corners of the face it lies on and their weights.
struct SurfacePlace {
  std::vector<Index> vertices;
  std::vector<double> weights;
  double distance = 0;  ///< from the place asked for [m]
};
/// The nearest place of a surface, with linear weights in triangles (a quadrilateral is two of them).
SurfacePlace nearest_place(const modes::ModalModel& model, const Vec3& point);

/// The files of a structure: frequencies.csv, modal.csv, energies.csv, contact.csv, probes.csv, the moving
/// surface and the shapes of its modes. Opened when first written to; nothing without an output folder.
class PlateResults final {
 public:
  explicit PlateResults(const Structure& structure);

  void write_start();
  void write_fields(double time);
  void write_series(double time);

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
  mesh::Mesh
      surface_;  // the whole surface on rank 0, the places of its points being the vertices of the model
  std::vector<SurfacePlace> probes_;
  std::optional<io::FieldWriter> fields_;
  std::optional<io::Series> modal_, energies_, contact_, probe_series_, static_;
};

}  // namespace couplet::plate
