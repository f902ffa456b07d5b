// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/build_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/constants.hpp"
#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/gmsh.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/quality.hpp"
#include "common/mesh/readers/read_msh.hpp"
#include "common/modes/modal_checks.hpp"
#include "common/modes/modal_model.hpp"
#include "plate_modal/model/midsurface.hpp"

namespace couplet::plate {
namespace {

/// Increment when the same input would produce different modes.
constexpr int model_version = 3;

/// FNV-1a hash of all data that affect the modes.
class ModesHash final {
 public:
  void add(const void* data, std::size_t bytes) {
    const auto* at = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < bytes; ++i) hash_ = (hash_ ^ at[i]) * 1099511628211ull;
  }
  void add(double value) { add(&value, sizeof value); }
  void add(const Vec3& value) { add(value.data(), sizeof(double) * 3); }
  template <class T>
  void add(const std::vector<T>& values) {
    add(double(values.size()));
    add(values.data(), values.size() * sizeof(T));
  }
  std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

std::vector<Support> supports(const Midsurface& surface, const Parameters& p) {
  std::vector<Support> result;
  for (const std::string& patch : surface.patches) result.push_back(p.boundaries.at(patch).support);
  return result;
}

/// Membrane stretching stiffens a plate with fixed edges by about an eighth at these deflections: a clamped
/// circle as 1 + 0.49 (w/h)^2, a hinged one as 1 + 1.85 (w/h)^2 [Timoshenko and Woinowsky-Krieger 1959,
/// section 97], hinged strips as 1 + 3 (w/h)^2.
double stretch_limit(const std::vector<Support>& patches) {
  const auto n = [&](Support s) { return std::ranges::count(patches, s); };
  if (n(Support::free) > 0 && n(Support::clamped) + n(Support::simply_supported) < 2) return 0;
  return n(Support::simply_supported) > 0 ? 0.2 : 0.5;
}

std::vector<bool> open_patches(const Midsurface& surface, const Parameters& p) {
  std::vector<bool> result;
  for (const Support support : supports(surface, p)) result.push_back(support == Support::free);
  return result;
}

std::string key_of(const PlateModel& plate, const Parameters& p) {
  const Midsurface& s = plate.surface();
  ModesHash key;
  key.add(double(model_version));
  key.add(double(p.n_modes()));
  for (const Vec2& x : s.points) key.add(x.x()), key.add(x.y());
  key.add(s.cells.offset);
  key.add(s.cells.index);
  for (Index c = 0; c < s.cells.size(); ++c) {
    const PlateCell& cell = plate.cell(c);
    for (const double v : {cell.thickness, cell.density, cell.youngs_modulus, cell.poissons_ratio})
      key.add(v);
  }
  const std::vector<Support> held = supports(s, p);
  for (const auto& e : s.edges)
    key.add(double(e.from)), key.add(double(e.to)), key.add(double(e.curve)), key.add(double(held[e.patch]));
  for (const Vec3& v : {p.placement.origin, p.placement.x, p.placement.y}) key.add(v);
  key.add(double(p.wetted));
  return key.text();
}

std::vector<std::string> quoted(const std::vector<std::string>& names) {
  std::vector<std::string> result;
  for (const std::string& name : names) result.push_back("'" + name + "'");
  return result;
}

void check_names(const Midsurface& s, const Parameters& p, const std::string& name) {
  for (const auto& [zone, values] : p.zones)
    if (std::ranges::find(s.zones, zone) == s.zones.end())
      throw Error("participants.{}.zones: the mesh has no zone '{}'; it has {}.", name, zone,
                  base::join(quoted(s.zones)));
  for (const auto& [patch, values] : p.boundaries)
    if (std::ranges::find(s.patches, patch) == s.patches.end())
      throw Error("participants.{}.boundaries: the mesh has no patch '{}'; it has {}.", name, patch,
                  base::join(quoted(s.patches)));
  for (const std::string& patch : s.patches)
    if (!p.boundaries.contains(patch))
      throw Error(
          "participants.{}.boundaries: patch '{}' has no entry; give it type: free, clamped, simply-supported or symmetry.",
          name, patch);
}

/// File of the mesh; a drawing is meshed first.
std::filesystem::path mesh_file(const Parameters& p, const std::filesystem::path& folder, int dimension) {
  const std::filesystem::path file = folder / *p.mesh;
  mesh::check_mesh_file(file, p.mesh_parameters);
  if (file.extension() == ".geo") return mesh::mesh_geo(file, dimension, p.mesh_parameters);
  return mesh::is_foreign(file.extension()) ? file : mesh::convert_mesh(file);
}

/// Mesh of a file with scaled lengths.
mesh::RawMesh read_scaled(const std::filesystem::path& file, double scale) {
  mesh::RawMesh raw = mesh::is_foreign(file.extension()) ? mesh::read_foreign(file) : mesh::read_msh(file);
  for (Vec3& x : raw.points) x *= scale;
  return raw;
}

/// Mid-surface of the mesh in the parameters, with scaled lengths.
Midsurface read(const Parameters& p, const std::filesystem::path& folder) {
  const std::filesystem::path file = mesh_file(p, folder, 2);
  mesh::RawMesh raw = read_scaled(file, p.mesh_scale);
  if (raw.dim != 2 || raw.cell_type.empty())
    throw Error(
        "The mesh '{}' is not two-dimensional. The mid-surface of a plate needs a 2-D mesh with its surface "
        "in a physical group.",
        (folder / *p.mesh).string());
  std::vector<int> entities;
  if (!mesh::is_foreign(file.extension())) entities = mesh::read_boundary_entities(file);
  entities.resize(raw.boundary_patch.size(), 0);  // none of the patch 'rest'
  Midsurface surface = midsurface_of(raw, entities);
  for (Vec3& x : raw.points) x.z() = 0;  // what rounding the file left of another plane
  const mesh::LoadedMesh flat = mesh::distribute(MPI_COMM_SELF, raw);
  mesh::check_and_report(flat.mesh, flat.geometry);
  return surface;
}

/// Largest eigenvalue of a rigid motion, due to round-off of the stiffness [1/s^2].
double rigid_limit(const PlateModel& plate) { return 1e-6 * plate.frequency_scale(); }

/// Throws Error if only some of a free plate's rigid motions were found.
void refuse_lost_rigid(const PlateModel& plate, const modes::EigenModes& modes) {
  if (!(modes.next < rigid_limit(plate))) return;
  const modes::EigenModes first = plate.modes(3);  // there are no more: a fall and two turns
  const auto rigid =
      std::ranges::count_if(first.eigenvalue, [&](double value) { return value < rigid_limit(plate); });
  throw Error(
      "modes.number: the plate has {} free rigid-body motions (modes of 0 Hz), but only {} of them would be kept, so that it "
      "could move in some directions but not in others. Keep at least {}.",
      rigid, modes.eigenvalue.size(), rigid);
}

/// Key of the input with a digest of the results, so that a file with edited values is not reused.
std::string key_with_content(const std::string& key, const modes::ModalModel& model) {
  ModesHash content;
  content.add(model.vertices);
  content.add(model.faces.offset);
  content.add(model.faces.index);
  for (const auto* part :
       {&model.frequency, &model.vertex_shape, &model.face_shape, &model.participation, &model.face_density})
    content.add(*part);
  content.add(model.mass);
  return key + "-" + content.text();
}

/// Reuses the modes of an earlier run if they belong to the same mesh and data and are unmodified.
bool reuse_modes(Built& built, const std::filesystem::path& file, const std::string& key) {
  const std::string kept = modes::key_of_modes(file);
  if (!kept.starts_with(key + "-")) return false;
  try {
    modes::ModalModel model = modes::read_modes(file);
    if (key_with_content(key, model) == kept) {
      built.model = std::move(model);
      built.reused = true;
      return true;
    }
  } catch (const Error&) {  // said below
  }
  log::warn("The modes file '{}' was modified; recomputing the modes.", file.string());
  return false;
}

/// Adds notes about curved edges drawn as straight lines.
void check_corners(Built& built, const Midsurface& surface, const std::vector<Support>& support) {
  const std::vector<OutlinePoint> outline = outline_of(surface);
  const std::vector<Index> corners = blunt_corners(surface, outline, support);
  if (corners.empty()) return;
  double least = std::numbers::pi, most = 0, order = 2;
  for (const Index p : corners) {
    const double kink = outline[p].kink;
    built.kinks.push_back(kink);
    least = std::min(least, std::abs(kink)), most = std::max(most, std::abs(kink));
    order = std::min(order, order_at_corner(kink));
  }
  const Vec2& x = surface.points[corners.front()];
  built.outline = fmt::format(
      "the simply supported outline has {} corner{} between straight edges that turn{} by {:.3g} to {:.3g} degrees, one at "
      "({:.4g}, {:.4g}): moments are singular there, and the error decreases as h^{:.2g} instead of h^2, with cell size h. A "
      "polygonal plate deflects less than one with a curved edge, however many sides it has (Babuska's paradox), and obtuse "
      "corners need a very fine mesh: with 13 edges per side a 20-gon deflects 13 % too much, with 16 edges per side a 12-gon "
      "22 % too little. Draw curved edges as curves (Circle, Ellipse, Spline); otherwise compare with a finer mesh.",
      corners.size(), corners.size() > 1 ? "s" : "", corners.size() > 1 ? "" : "s", least / base::degree,
      most / base::degree, x.x(), x.y(), order);
}

void add_modes(Built& built, const PlateModel& plate, const Parameters& p, const PlateContext& context) {
  const std::filesystem::path file = context.output_folder / "modes.h5";
  const std::string key = key_of(plate, p);
  if (!context.output_folder.empty() && reuse_modes(built, file, key)) return;
  const modes::EigenModes modes = plate.modes(p.n_modes());
  refuse_lost_rigid(plate, modes);
  if (modes::cuts_a_group(modes, 1e-3))
    built.note = fmt::format(
        "modes {} and {} have the same frequency (to 0.1 %), but only the first is kept, so the response "
        "differs between equivalent directions. Keep one more or one fewer.",
        p.n_modes(), p.n_modes() + 1);
  built.model = skin_of(plate, modes, p.placement, p.wetted, open_patches(plate.surface(), p));
  const double least = std::sqrt(rigid_limit(plate)) / (2 * std::numbers::pi);
  for (double& f : built.model.frequency)
    if (f < least) f = 0;
  // Without the key, modes are recomputed and their notes are repeated.
  if (!context.output_folder.empty())
    base::when_started(
        [file, model = built.model, key = built.note.empty() ? key_with_content(key, built.model) : ""] {
          modes::write_modes(file, model, key);
        });
}

}  // namespace

mesh::RawMesh read_raw(const Parameters& p, const std::filesystem::path& folder, int dimension) {
  return read_scaled(mesh_file(p, folder, dimension), p.mesh_scale);
}

PlateModel plate_of(Midsurface surface, const Parameters& p, const std::string& name) {
  check_names(surface, p, name);
  std::vector<PlateCell> of_zone;
  for (const std::string& zone : surface.zones) {
    const auto found = p.zones.find(zone);
    const Zone other = found == p.zones.end() ? Zone{} : found->second;
    of_zone.push_back({other.thickness.value_or(p.thickness), other.density.value_or(p.material.density),
                       other.youngs_modulus.value_or(p.material.youngs_modulus), p.material.poissons_ratio});
  }
  std::vector<PlateCell> cells;
  for (const int zone : surface.zone) cells.push_back(of_zone[zone]);
  const std::vector<Support> support = supports(surface, p);
  return PlateModel(std::move(surface), std::move(cells), support);
}

modes::ModalModel modes_of_file(const Parameters& p, const std::filesystem::path& file) {
  modes::ModalModel model = modes::read_modes(file);
  const std::string problem =
      modes::facing_problem_of(model, p.cavity ? modes::Facing::inward : modes::Facing::outward);
  if (problem.empty()) return model;
  throw Error(
      "modes.file: cannot use the modes file '{}': {}. {}docs/formats.md describes the required content.",
      file.string(), problem,
      p.cavity ? ""
               : "If it is the wall of a cavity, with the enclosed space outside of the structure, set "
                 "'modes.cavity: true'. ");
}

std::vector<app::ProblemOfKey> problems_of_files(const Parameters& p, const std::filesystem::path& folder) {
  if (!p.modes_file) return {};
  try {
    (void)modes_of_file(p, folder / *p.modes_file);
  } catch (const Error& error) {
    return {{"modes.file", error.what()}};
  }
  return {};
}

Built build_model(const Parameters& p, const PlateContext& context, const mesh::RawMesh* raw) {
  Built built;
  mesh::on_root(context.comm, [&] {
    if (p.modes_file) {
      built.model = modes_of_file(p, context.case_folder / *p.modes_file);
      return;
    }
    auto plate = std::make_unique<PlateModel>(
        plate_of(raw ? midsurface_of(*raw) : read(p, context.case_folder), p, context.name));
    const std::vector<Support> held = supports(plate->surface(), p);
    check_corners(built, plate->surface(), held);
    built.stretch_limit = stretch_limit(held);
    add_modes(built, *plate, p, context);
    if (p.analysis != Parameters::Analysis::modal) built.plate = std::move(plate);
  });
  modes::ModalModel& m = built.model;
  std::vector<double> numbers{m.mass, built.stretch_limit};
  for (auto* part : {&numbers, &m.frequency, &m.vertex_shape, &m.face_shape, &m.participation,
                     &m.face_density, &built.kinks})
    mesh::broadcast(context.comm, *part);
  m.mass = numbers[0], built.stretch_limit = numbers[1];
  mesh::broadcast(context.comm, m.vertices);
  mesh::broadcast(context.comm, m.faces.offset);
  mesh::broadcast(context.comm, m.faces.index);
  return built;
}

double seat_stiffness(const Parameters& p) {
  return p.material.youngs_modulus / (3 * (1 - 2 * p.material.poissons_ratio)) / p.thickness;
}

}  // namespace couplet::plate
