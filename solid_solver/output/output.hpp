// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/io/fields/surface_series.hpp"
#include "common/modes/pencil.hpp"
#include "solid_solver/body/solid_body.hpp"
#include "solid_solver/body/solid_fields.hpp"
#include "solid_solver/motion/solid_stepper.hpp"
#include "solid_solver/output/files.hpp"
#include "solid_solver/output/probes.hpp"

namespace couplet::solid {

/// Writes surface-<patch>.h5 for `output.surfaces`: displacement and stress at points, traction of faces, and
/// fields of effects (temperature, heat flux).
class SolidSurfaces {
 public:
  /// Keeps references. Throws Error for an unknown patch. Collective.
  SolidSurfaces(const SolidFields& derived, const SolidBody& body, const SolidContext& context);
  /// `points`: displacement of all local points. `places`: their positions. Collective.
  void write(double time, std::span<const double> points, std::span<const Vec3> places);

 private:
  const SolidFields& derived_;
  const SolidBody& body_;
  const SolidContext& context_;
  io::SurfaceSeries series_;
  std::vector<std::uint8_t> wanted_;  // points with stress
  bool is_open_ = false;
};

/// Writes the files of a solid: fields, surfaces, probes.csv, reactions.csv, solver.csv. Each is opened on
/// first use.
class SolidOutput {
 public:
  /// Keeps references.
  SolidOutput(const SolidFields& derived, const SolidStepper& stepper, const SolidBody& body,
              const SolidContext& context);

  /// Writes fields of output `number`, and surfaces. `points`: displacement of all local points.
  void write_fields(double time, int number, std::span<const double> points);
  void write_series(double time, std::span<const double> points);
  /// Writes spectrum.csv and a log entry for steps of dt. Collective.
  void write_spectrum(double dt);
  /// Writes modes.csv and, in 3-D, modes.h5. The log includes the mesh error of the frequencies. Collective.
  void write_modes();
  /// Writes modes.csv and modes.h5 of the accepted state of a linear static run. Collective.
  void write_preloaded_modes();
  /// Writes buckling.csv, buckling.xdmf and a log entry. Collective.
  void write_buckling();
  /// Lowest load factor of write_buckling(); empty if not computed or there is none.
  std::optional<double> buckling_factor() const { return buckling_factor_; }
  const SolidProbes& probes() const { return probes_; }

 private:
  void write_volume(double time, std::span<const double> points, std::span<const Vec3> places);
  void write_shapes(const char* file, const char* name, const std::vector<std::vector<double>>& shapes);
  void write_vibrations(const SolidProblem& problem, const modes::EigenModes& found, const char* of);
  void write_probes(double time, std::span<const double> points);
  void write_reactions(double time, std::span<const double> points);
  void write_contact(double time);

  const SolidFields& derived_;
  const SolidStepper& stepper_;
  const SolidBody& body_;
  const SolidContext& context_;
  SolidProbes probes_;
  bool spectrum_written_ = false, modes_written_ = false;
  std::optional<double> buckling_factor_;
  std::optional<io::FieldWriter> fields_;
  std::optional<SolidSurfaces> surfaces_;
  SeriesFiles series_;
};

}  // namespace couplet::solid
