// SPDX-License-Identifier: Apache-2.0
#include "common/modes/modes_file.hpp"

#include "common/base/error.hpp"
#include "common/io/hdf5.hpp"
#include "common/modes/modal_checks.hpp"

namespace couplet {
namespace {

constexpr const char* format_name = "couplet modes";
constexpr int format_version = 1;

hdf5::Rows rows(std::size_t n, std::size_t width) { return {0, n, n, width}; }

void write(hid_t id, const char* path, const std::vector<double>& values, std::size_t width) {
  hdf5::write_table(id, path, rows(values.size() / width, width), values.data());
}

/// Values in a row of a table.
std::size_t width_of(hid_t id, const char* path) {
  const hdf5::Handle table(H5Dopen2(id, path, H5P_DEFAULT), H5Dclose);
  const hdf5::Handle space(H5Dget_space(table), H5Sclose);
  hsize_t size[H5S_MAX_RANK] = {0};
  const int dimensions = H5Sget_simple_extent_dims(space, size, nullptr);
  std::size_t width = 1;
  for (int d = 1; d < dimensions; ++d) width *= size[d];
  return width;
}

std::vector<double> read(hid_t id, const char* path, std::size_t n, std::size_t width) {
  if (!hdf5::exists(id, path)) throw Error("it has no table '{}'", path);
  if (width_of(id, path) != width)
    throw Error("the table '{}' has {} values a row; {} are needed", path, width_of(id, path), width);
  if (hdf5::table_length(id, path) != n)
    throw Error("the table '{}' has {} rows; {} are needed", path, hdf5::table_length(id, path), n);
  std::vector<double> values(n * width);
  hdf5::read_table(id, path, rows(n, width), values.data());
  return values;
}

void read_faces(hid_t id, Csr& faces) {
  for (const char* path : {"surface/face-offset", "surface/face-vertex"})
    if (!hdf5::exists(id, path)) throw Error("it has no table '{}'", path);
  std::vector<std::int64_t> offset(hdf5::table_length(id, "surface/face-offset"));
  std::vector<std::int64_t> vertex(hdf5::table_length(id, "surface/face-vertex"));
  hdf5::read_table(id, "surface/face-offset", rows(offset.size(), 1), offset.data());
  hdf5::read_table(id, "surface/face-vertex", rows(vertex.size(), 1), vertex.data());
  bool sound = !offset.empty() && offset.front() == 0 && offset.back() == std::int64_t(vertex.size());
  for (std::size_t f = 1; f < offset.size(); ++f) sound = sound && offset[f] >= offset[f - 1];
  if (!sound) throw Error("'surface/face-offset' must grow from 0 to the length of 'surface/face-vertex'");
  faces.offset.assign(offset.begin(), offset.end());
  faces.index.assign(vertex.begin(), vertex.end());
}

ModalModel read_model(hid_t id) {
  if (hdf5::read_text_attribute(id, "format") != format_name) throw Error("it is not a file of modes");
  if (hdf5::read_attribute(id, "version") != format_version)
    throw Error("its version is {}; {} is read", hdf5::read_attribute(id, "version"), format_version);
  ModalModel model;
  if (!hdf5::exists(id, "frequency")) throw Error("it has no table 'frequency'");
  const std::size_t n = hdf5::table_length(id, "frequency");
  model.frequency = read(id, "frequency", n, 1);
  if (!hdf5::exists(id, "surface/vertices")) throw Error("it has no table 'surface/vertices'");
  const std::size_t vertices = hdf5::table_length(id, "surface/vertices");
  const std::vector<double> places = read(id, "surface/vertices", vertices, 3);
  for (std::size_t v = 0; v < vertices; ++v) model.vertices.emplace_back(&places[3 * v]);
  read_faces(id, model.faces);
  model.vertex_shape = read(id, "shape/vertices", 3 * vertices, n);
  model.participation = read(id, "participation", 3, n);
  model.mass = hdf5::read_attribute(id, "mass");
  const std::size_t faces = model.faces.size();
  if (hdf5::exists(id, "surface/face-density"))
    model.face_density = read(id, "surface/face-density", faces, 1);
  if (hdf5::exists(id, "shape/faces")) {
    model.face_shape = read(id, "shape/faces", 3 * faces, n);
  } else {
    model.face_shape.assign(faces * 3 * n, 0);
    if (const std::string problem = problem_of(model); !problem.empty()) throw Error("{}", problem);
    average_faces(model);
  }
  for (const auto look :
       {&problem_of, &order_problem_of, &impossible_in, &scale_problem_of, &overlap_problem_of})
    if (const std::string problem = look(model); !problem.empty()) throw Error("{}", problem);
  return model;
}

}  // namespace

void write_modes(const std::filesystem::path& file, const ModalModel& model, const std::string& key) {
  const std::filesystem::path part = file.string() + ".part";
  const std::size_t n = model.n_modes();
  {
    const hdf5::Handle id = hdf5::create_file(MPI_COMM_SELF, part);
    hdf5::write_attribute(id, "format", std::string(format_name));
    hdf5::write_attribute(id, "version", double(format_version));
    hdf5::write_attribute(id, "key", key);
    hdf5::write_attribute(id, "mass", model.mass);
    std::vector<double> places;
    for (const Vec3& x : model.vertices) places.insert(places.end(), x.begin(), x.end());
    const std::vector<std::int64_t> offset(model.faces.offset.begin(), model.faces.offset.end());
    const std::vector<std::int64_t> vertex(model.faces.index.begin(), model.faces.index.end());
    write(id, "frequency", model.frequency, 1);
    write(id, "surface/vertices", places, 3);
    hdf5::write_table(id, "surface/face-offset", rows(offset.size(), 1), offset.data());
    hdf5::write_table(id, "surface/face-vertex", rows(vertex.size(), 1), vertex.data());
    if (!model.face_density.empty()) write(id, "surface/face-density", model.face_density, 1);
    write(id, "shape/vertices", model.vertex_shape, n);
    write(id, "shape/faces", model.face_shape, n);
    write(id, "participation", model.participation, n);
  }
  std::error_code failed;
  std::filesystem::rename(part, file, failed);
  if (failed)
    throw Error("The file of modes '{}' could not be written: {}.", file.string(), failed.message());
}

ModalModel read_modes(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw Error("The file of modes '{}' does not exist. The path is relative to the folder of the YAML file.",
                file.string());
  try {
    const hdf5::Quiet quiet;
    const hdf5::Handle id = hdf5::open_file_to_read(file);
    return read_model(id);
  } catch (const Error& error) {
    std::string reason = error.what();
    if (reason.ends_with('.')) reason.pop_back();
    throw Error("The file of modes '{}' cannot be used: {}. docs/formats.md says what it must hold.",
                file.string(), reason);
  }
}

std::string key_of_modes(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return "";
  try {
    const hdf5::Quiet quiet;
    const hdf5::Handle id = hdf5::open_file_to_read(file);
    return hdf5::read_text_attribute(id, "key");
  } catch (const Error&) {
    return "";  // damaged or of another kind: it is made anew
  }
}

}  // namespace couplet
