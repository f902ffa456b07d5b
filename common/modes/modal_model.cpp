// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modal_model.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/io/hdf5.hpp"
#include "common/modes/modal_checks.hpp"

namespace couplet::modes {

RigidMotion rigid_motion(const ModalModel& model, std::size_t mode) {
  RigidMotion motion;
  const std::size_t n = model.n_modes(), n_vertices = model.vertices.size();
  if (n_vertices == 0) return motion;
  const auto shape = [&](std::size_t v) {
    const double* u = model.vertex_shape.data() + 3 * v * n + mode;
    return Vec3(u[0], u[n], u[2 * n]);
  };
  Vec3 centre = Vec3::Zero();
  for (std::size_t v = 0; v < n_vertices; ++v) {
    centre += model.vertices[v] / double(n_vertices);
    motion.translation += shape(v) / double(n_vertices);
  }
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vec3 moment = Vec3::Zero();
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 r = model.vertices[v] - centre;
    inertia += r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose();
    moment += r.cross(shape(v));
  }
  // Dynamic sizes are used because GCC 12 reports a false out-of-bounds read in Eigen's AVX code for 3x3.
  motion.rotation = Eigen::MatrixXd(inertia).completeOrthogonalDecomposition().solve(Eigen::VectorXd(moment));
  double left = 0, all = 0;
  for (std::size_t v = 0; v < n_vertices; ++v) {
    const Vec3 u = shape(v);
    left += (u - motion.translation - motion.rotation.cross(model.vertices[v] - centre)).squaredNorm();
    all += u.squaredNorm();
  }
  if (all > 0) motion.misfit = std::sqrt(left / all);
  return motion;
}

std::vector<Vec3> face_centres(const ModalModel& model) {
  std::vector<Vec3> centres;
  for (Index f = 0; f < model.faces.size(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const Index v : model.faces[f]) centre += model.vertices[v];
    centres.push_back(centre / double(model.faces[f].size()));
  }
  return centres;
}

Vec3 extent_of(const ModalModel& model) {
  Vec3 low = model.vertices.front(), high = low;
  for (const Vec3& x : model.vertices) low = low.cwiseMin(x), high = high.cwiseMax(x);
  return high - low;
}

std::vector<Vec3> face_areas(const ModalModel& model) {
  std::vector<Vec3> areas;
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto v = model.faces[f];
    const Vec3 a = model.vertices[v[2]] - model.vertices[v[0]];
    const Vec3 b = v.size() == 3 ? Vec3(model.vertices[v[2]] - model.vertices[v[1]])
                                 : Vec3(model.vertices[v[3]] - model.vertices[v[1]]);
    // For a triangle (x2 - x0) x (x2 - x1) / 2 has the sign of (x1 - x0) x (x2 - x0) / 2.
    areas.push_back(v.size() == 3 ? Vec3(0.5 * (model.vertices[v[1]] - model.vertices[v[0]]).cross(a))
                                  : Vec3(0.5 * a.cross(b)));
  }
  return areas;
}

void average_faces(ModalModel& model) {
  const std::size_t n = model.n_modes();
  model.face_shape.assign(std::size_t(model.faces.size()) * 3 * n, 0);
  for (Index f = 0; f < model.faces.size(); ++f) {
    const auto corners = model.faces[f];
    for (const Index v : corners)
      for (std::size_t i = 0; i < 3 * n; ++i)
        model.face_shape[std::size_t(f) * 3 * n + i] +=
            model.vertex_shape[std::size_t(v) * 3 * n + i] / double(corners.size());
  }
}

double largest_displacement(const ModalModel& model, std::size_t mode) {
  const std::size_t n = model.n_modes();
  double largest = 0;
  for (std::size_t v = 0; v < model.vertices.size(); ++v) {
    const double* u = model.vertex_shape.data() + 3 * v * n + mode;
    largest = std::max(largest, Vec3(u[0], u[n], u[2 * n]).norm());
  }
  return largest;
}

namespace {

constexpr const char* format_name = "couplet modes";
constexpr int format_version = 1;

io::hdf5::RowSpan rows(std::size_t n, std::size_t width) { return {0, n, n, width}; }

void write(const io::hdf5::Handle& id, const char* path, const std::vector<double>& values,
           std::size_t width) {
  io::hdf5::write_table(id, path, rows(values.size() / width, width), values.data());
}

constexpr const char* what = "modes file";
constexpr const char* advice = "docs/formats.md describes the required content.";
constexpr std::uint64_t most_modes = 2000;  // all pairs are compared

std::vector<std::int64_t> read_integers(const io::hdf5::Reader& file, const char* path) {
  const std::size_t n = file.rows(path, 1);
  std::vector<std::int64_t> values(n);
  file.read(path, rows(n, 1), values.data());
  return values;
}

void read_faces(const io::hdf5::Reader& file, mesh::Csr& faces) {
  const std::vector<std::int64_t> offset = read_integers(file, "surface/face-offset"),
                                  vertex = read_integers(file, "surface/face-vertex");
  constexpr std::int64_t most = std::numeric_limits<Index>::max();
  bool sound = !offset.empty() && offset.front() == 0 && offset.back() == std::int64_t(vertex.size());
  for (std::size_t f = 1; f < offset.size(); ++f) sound = sound && offset[f] >= offset[f - 1];
  if (!sound)
    file.refuse("'surface/face-offset' must increase from 0 to the length of 'surface/face-vertex'");
  for (const std::int64_t v : vertex)
    if (v < 0 || v > most) file.refuse(fmt::format("'surface/face-vertex' contains vertex {}", v));
  faces.offset.assign(offset.begin(), offset.end());
  faces.index.assign(vertex.begin(), vertex.end());
}

/// Reads the file without checking the model.
ModalModel read_tables(const io::hdf5::Reader& file) {
  if (file.text("/", "format") != format_name) file.refuse("it is not a modes file");
  if (const double version = file.number("/", "version"); version != format_version)
    file.refuse(fmt::format("its version is {}; expected {}", version, format_version));
  ModalModel model;
  const std::uint64_t n = file.rows("frequency", 1);
  if (n > most_modes)
    file.refuse(fmt::format("'frequency' has {} rows; at most {} modes are supported", n, most_modes));
  model.frequency = file.table("frequency", n, 1);
  const std::uint64_t vertices = file.rows("surface/vertices", 3);
  const std::vector<double> places = file.table("surface/vertices", vertices, 3);
  for (std::size_t v = 0; v < vertices; ++v) model.vertices.emplace_back(&places[3 * v]);
  read_faces(file, model.faces);
  model.vertex_shape = file.table("shape/vertices", 3 * vertices, n);
  model.participation = file.table("participation", 3, n);
  model.mass = file.number("/", "mass");
  const std::size_t faces = model.faces.size();
  if (faces > 8 * (vertices + 1))
    file.refuse(
        fmt::format("{} faces have {} vertices; a surface has at most 2 faces per vertex", faces, vertices));
  if (file.has("surface/face-density")) model.face_density = file.table("surface/face-density", faces, 1);
  if (file.has("shape/faces")) model.face_shape = file.table("shape/faces", 3 * faces, n);
  return model;
}

ModalModel read_model(const io::hdf5::Reader& file) {
  ModalModel model = read_tables(file);
  if (model.face_shape.empty()) {
    model.face_shape.assign(model.faces.size() * 3 * model.n_modes(), 0);
    if (const std::string problem = problem_of(model); !problem.empty()) file.refuse(problem);
    average_faces(model);
  }
  for (const auto look :
       {&problem_of, &order_problem_of, &impossible_in, &scale_problem_of, &overlap_problem_of})
    if (const std::string problem = look(model); !problem.empty()) file.refuse(problem);
  return model;
}

}  // namespace

void write_modes(const std::filesystem::path& file, const ModalModel& model, const std::string& key) {
  const std::filesystem::path part = file.string() + ".part";
  const std::size_t n = model.n_modes();
  {
    io::hdf5::Handle id = io::hdf5::create_file(MPI_COMM_SELF, part);
    io::hdf5::write_attribute(id, "format", std::string(format_name));
    io::hdf5::write_attribute(id, "version", double(format_version));
    io::hdf5::write_attribute(id, "key", key);
    io::hdf5::write_attribute(id, "mass", model.mass);
    std::vector<double> places;
    for (const Vec3& x : model.vertices) places.insert(places.end(), x.begin(), x.end());
    const std::vector<std::int64_t> offset(model.faces.offset.begin(), model.faces.offset.end());
    const std::vector<std::int64_t> vertex(model.faces.index.begin(), model.faces.index.end());
    write(id, "frequency", model.frequency, 1);
    write(id, "surface/vertices", places, 3);
    io::hdf5::write_table(id, "surface/face-offset", rows(offset.size(), 1), offset.data());
    io::hdf5::write_table(id, "surface/face-vertex", rows(vertex.size(), 1), vertex.data());
    if (!model.face_density.empty()) write(id, "surface/face-density", model.face_density, 1);
    write(id, "shape/vertices", model.vertex_shape, n);
    write(id, "shape/faces", model.face_shape, n);
    write(id, "participation", model.participation, n);
    io::hdf5::close_file(MPI_COMM_SELF, id, part);
  }
  std::error_code failed;
  std::filesystem::rename(part, file, failed);
  if (failed) throw Error("Cannot write the modes file '{}': {}.", file.string(), failed.message());
}

ModalModel read_modes(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw Error("The modes file '{}' does not exist. The path is relative to the folder of the YAML file.",
                file.string());
  return read_model(io::hdf5::Reader(file, what, advice));
}

std::string missing_by_symmetry(const std::vector<std::string>& patches, const char* instead) {
  if (patches.empty()) return "";
  return fmt::format(
      "symmetry ('{}'): only mode shapes that are symmetric about this plane were computed; the antisymmetric ones are "
      "missing. Repeat the run with {} there, on one plane at a time and on all of them (a patch that covers two planes must "
      "be split).",
      base::join(patches, "', '"), instead);
}

std::string key_of_modes(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return "";
  try {
    return io::hdf5::Reader(file, what).text("/", "key");
  } catch (const Error&) {
    return "";  // damaged or of another kind: recreated
  }
}

}  // namespace couplet::modes
