// SPDX-License-Identifier: Apache-2.0
#include "common/io/fields/field_writer.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include "common/io/checkpoint_set.hpp"
#include "common/io/fields/xdmf.hpp"
#include "common/io/hdf5.hpp"
#include "common/log/log.hpp"
#include "common/parallel/collective.hpp"
#include "common/parallel/index_map.hpp"

namespace couplet::io {
namespace {

constexpr const char *fields_format = "couplet fields", *surface_format = "couplet surface";
constexpr std::size_t most_fields = 1000;  // of one kind in one output

std::string step_name(int number) { return fmt::format("steps/{:06d}", number); }

// Cells in the format of XDMF: a table of points for one cell type, or a flat list of code and points for
// mixed ones.
struct Topology {
  std::int64_t kind = 0;  // XDMF code of all cells; 0 if mixed
  std::uint64_t width = 1;
  std::vector<std::int64_t> values;
};

std::int64_t code_of(const mesh::Mesh& mesh, Index cell) {
  return mesh.cell_points[cell].size() == 2 ? xdmf::edge_code : xdmf::cell_code(mesh.cell_type[cell]);
}

Topology make_topology(const mesh::Mesh& mesh) {
  const Index n = mesh.cells.n_owned();
  std::int64_t lowest = std::numeric_limits<std::int64_t>::max(), highest = 0;
  for (Index c = 0; c < n; ++c) {
    lowest = std::min(lowest, code_of(mesh, c));
    highest = std::max(highest, code_of(mesh, c));
  }
  MPI_Allreduce(MPI_IN_PLACE, &lowest, 1, MPI_INT64_T, MPI_MIN, mesh.comm);
  MPI_Allreduce(MPI_IN_PLACE, &highest, 1, MPI_INT64_T, MPI_MAX, mesh.comm);
  Topology topology;
  if (lowest == highest) {
    topology.kind = lowest;
    topology.width = xdmf::points_of(lowest);
  }
  for (Index c = 0; c < n; ++c) {
    if (topology.kind == 0) topology.values.push_back(code_of(mesh, c));
    const auto points = mesh.cell_points[c];
    // VTK's prism is inverted: the normal of its first triangle points outwards, ours points inwards.
    constexpr int prism[6] = {0, 2, 1, 3, 5, 4};
    for (std::size_t i = 0; i < points.size(); ++i)
      topology.values.push_back(
          mesh.points.global(points[mesh.cell_type[c] == mesh::CellType::prism ? std::size_t(prism[i]) : i]));
  }
  return topology;
}

}  // namespace

struct FieldWriter::FieldFiles {
  const mesh::Mesh& mesh;
  std::filesystem::path folder;
  std::string name;
  bool moving;
  std::string format;
  xdmf::FieldIndex index;  // complete only on rank 0
  int number = 0;          // of the next entry
  hdf5::RowSpan point_rows, cell_rows;
  // Numbers in the file, of as many rows as this rank has.
  std::vector<GlobalIndex> points_there{}, cells_there{};
  int compression = 0;
  std::optional<parallel::GlobalOrder> point_order{}, cell_order{};  // of the file; empty if in local order

  std::filesystem::path file() const { return folder / (name + ".h5"); }

  void write_points(const hdf5::Handle& id, const std::string& path, std::span<const Vec3> points) const {
    std::vector<double> flat(3 * std::size_t(mesh.points.n_owned()));
    for (Index p = 0; p < mesh.points.n_owned(); ++p)
      for (int d = 0; d < 3; ++d) flat[3 * std::size_t(p) + d] = points[p][d];
    write_rows(id, path, false, 3, flat);
  }

  void write_rows(const hdf5::Handle& id, const std::string& path, bool on_cells, std::size_t width,
                  std::span<const double> values) const {
    hdf5::RowSpan rows = on_cells ? cell_rows : point_rows;
    rows.width = width;
    rows.compression = compression;
    const auto& order = on_cells ? cell_order : point_order;
    if (!order) return hdf5::write_table(id, path, rows, values.data());
    rows.first = std::uint64_t(order->first()), rows.count = order->count();
    hdf5::write_table(id, path, rows, order->to_block(values, width).data());
  }

  void write_field(const hdf5::Handle& id, const std::string& path, const OutputField& field) const {
    const bool on_cells = field.place == OutputField::Place::cells;
    const parallel::IndexMap& map = on_cells ? mesh.cells : mesh.points;
    const std::size_t n = map.n_owned(), components = field.components;
    if (field.values.size() < n * components)
      throw Error("The output field '{}' has only {} values for {} {} with {} components each.", field.name,
                  field.values.size(), n, on_cells ? "cells" : "points", components);
    if (components != 2)
      return write_rows(id, path, on_cells, components, field.values.first(n * components));
    std::vector<double> padded(3 * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      padded[3 * i] = field.values[2 * i];
      padded[3 * i + 1] = field.values[2 * i + 1];
    }
    write_rows(id, path, on_cells, 3, padded);
  }

  void begin(std::span<const Vec3> places, double restart_time);
  void start(std::span<const Vec3> places);
  bool continue_from(double restart_time);
  void set_aside(const std::string& problem);
  void find_order();
  /// Reads the entries of an earlier run up to `restart_time`. Returns the names of later outputs.
  std::vector<std::string> read_index(double restart_time);
  void read_entries(const hdf5::Reader& file, const std::vector<std::string>& steps, double restart_time);
};

void FieldWriter::FieldFiles::start(std::span<const Vec3> places) {
  hdf5::Handle id = hdf5::create_file(mesh.comm, file());
  hdf5::write_attribute(id, "format", format);
  hdf5::write_attribute(id, "ranks", double(parallel::comm_size(mesh.comm)));
  const Topology topology = make_topology(mesh);
  const hdf5::RowSpan rows =
      hdf5::distribute_rows(mesh.comm, topology.values.size() / topology.width, topology.width);
  hdf5::write_table(id, "mesh/cells", rows, topology.values.data());
  hdf5::write_table(id, "mesh/cell-id", cell_rows, mesh.cell_id.data());
  hdf5::write_table(id, "mesh/point-id", point_rows, mesh.point_id.data());
  write_points(id, "mesh/coordinates", places);
  hdf5::write_attribute(id, "kind", double(topology.kind));
  hdf5::close_file(mesh.comm, id, file());
  index = {file().filename().string(),
           topology.kind,
           rows.total * rows.width,
           cell_rows.total,
           point_rows.total,
           moving,
           {}};
}

void FieldWriter::FieldFiles::read_entries(const hdf5::Reader& file, const std::vector<std::string>& steps,
                                           double restart_time) {
  const double last = restart_time + 1e-9 * std::abs(restart_time);
  for (const std::string& step : steps) {
    const std::string group = "steps/" + step;
    const double time = file.number(group, "time");
    if (time > last) break;
    std::vector<xdmf::Field> fields;
    for (const std::string place : {"cells", "points"})
      for (const std::string& field : file.members(group + "/" + place, most_fields)) {
        const std::string table = group + "/" + place + "/" + field;
        const double components = file.number(table, "components");
        if (!(components >= 1 && components <= 9))
          file.refuse("'" + table + "' has an invalid number of components");
        fields.push_back({field, file.text(table, "unit"), place == "cells", int(components)});
      }
    index.add(group, time, std::move(fields));
  }
}

std::vector<std::string> FieldWriter::FieldFiles::read_index(double restart_time) {
  const hdf5::Reader in(file(), "output");
  if (in.text("/", "format") != format)
    in.refuse(format == surface_format ? "it is not a surface output file" : "it is not a field output file");
  const double kind = in.number("/", "kind");
  const auto known = {0, int(xdmf::edge_code), 4, 5, 6, 7, 8, 9};
  if (std::ranges::find(known, kind) == known.end())
    in.refuse(fmt::format("its cells have the unknown type {}", kind));
  index = {file().filename().string(), std::int64_t(kind), 0, cell_rows.total, point_rows.total, moving, {}};
  const std::uint64_t width = index.kind == 0 ? 1 : std::uint64_t(xdmf::points_of(index.kind));
  if (in.rows("mesh/cell-id", 1) != cell_rows.total || in.rows("mesh/point-id", 1) != point_rows.total)
    in.refuse("it was written for a different mesh");
  for (const auto& [table, rows, there] : {std::tuple("mesh/cell-id", cell_rows, &cells_there),
                                           std::tuple("mesh/point-id", point_rows, &points_there)}) {
    there->resize(rows.count);
    in.read(table, rows, there->data());
  }
  index.topology_size = in.rows("mesh/cells", width) * width;
  const std::vector<std::string> all = in.members("steps");
  read_entries(in, all, restart_time);
  return {all.begin() + std::ptrdiff_t(index.entries.size()), all.end()};
}

/// Finds the order of a file written on other ranks, so that new entries have the same order.
void FieldWriter::FieldFiles::find_order() {
  try {
    const auto here = [](const std::vector<GlobalIndex>& ids, const hdf5::RowSpan& rows) {
      return std::span(ids).first(rows.count);
    };
    cell_order = parallel::GlobalOrder::of_rows(mesh.comm, cells_there, here(mesh.cell_id, cell_rows));
    point_order = parallel::GlobalOrder::of_rows(mesh.comm, points_there, here(mesh.point_id, point_rows));
  } catch (const Error&) {
    throw Error("Cannot continue the output '{}': it was written for a different mesh.", file().string());
  }
}

bool FieldWriter::FieldFiles::continue_from(double restart_time) {
  int there = parallel::comm_rank(mesh.comm) == 0 && std::filesystem::exists(file()) ? 1 : 0;
  MPI_Bcast(&there, 1, MPI_INT, 0, mesh.comm);
  if (there == 0) {
    if (parallel::comm_rank(mesh.comm) == 0) warn_if_lost(file(), restart_time);
    return false;
  }
  try {
    const std::vector<std::string> dropped =
        parallel::on_all(mesh.comm, [&] { return read_index(restart_time); });
    find_order();
    number = static_cast<int>(index.entries.size());
    if (dropped.empty()) return true;
    hdf5::Handle id = hdf5::open_file_to_write(mesh.comm, file());
    for (const std::string& entry : dropped) hdf5::remove(id, "steps/" + entry);
    hdf5::close_file(mesh.comm, id, file());
    return true;
  } catch (const Error& problem) {  // the same on all ranks
    set_aside(problem.what());
    return false;
  }
}

/// Renames a file that cannot be continued. Damaged outputs must not keep a run from resuming, because its
/// state is in the checkpoint.
void FieldWriter::FieldFiles::set_aside(const std::string& problem) {
  point_order.reset();
  cell_order.reset();
  number = 0;
  parallel::on_root(mesh.comm, [&] {
    std::filesystem::path aside = file().string() + ".aside";
    while (std::filesystem::exists(aside)) aside += "-1";
    std::filesystem::rename(file(), aside);
    log::warn("{} It was renamed to '{}', and all further outputs go to a new file.", problem,
              aside.string());
  });
}

/// Creates the folder and continues an existing series or begins one. Collective.
void FieldWriter::FieldFiles::begin(std::span<const Vec3> places, double restart_time) {
  point_rows = hdf5::distribute_rows(mesh.comm, mesh.points.n_owned(), 1);
  cell_rows = hdf5::distribute_rows(mesh.comm, mesh.cells.n_owned(), 1);
  parallel::on_root(mesh.comm, [&] {
    std::error_code code;
    std::filesystem::create_directories(folder, code);
    if (!std::filesystem::is_directory(folder))
      throw Error("Cannot create the output folder '{}' ({}).", folder.string(), code.message());
  });
  if (std::isnan(restart_time) || !continue_from(restart_time)) start(places);
  if (parallel::comm_rank(mesh.comm) == 0) xdmf::write(folder / (name + ".xdmf"), index);
}

FieldWriter::FieldWriter(const mesh::Mesh& mesh, std::span<const Vec3> places, std::filesystem::path folder,
                         std::string name, bool moving, double restart_time, const FieldChoice& choice) {
  if (choice.box) {
    part_ = make_part(mesh, places, cells_within(mesh, places, *choice.box));
    if (parallel::sum(mesh.comm, GlobalIndex(part_->entries.size())) == 0) {
      if (parallel::comm_rank(mesh.comm) == 0)
        log::warn("simulation.output.box contains no cells of '{}', so its fields are not written.", name);
      return;
    }
  }
  state_ = std::make_unique<FieldFiles>(FieldFiles{
      part_ ? part_->mesh : mesh, std::move(folder), std::move(name), moving, fields_format, {}, 0, {}, {}});
  state_->compression = choice.compression;
  state_->begin(part_ ? part_->places : places, restart_time);
}

FieldWriter::FieldWriter(const MeshPart& surface, std::filesystem::path folder, std::string name, bool moving,
                         double restart_time)
    : state_(std::make_unique<FieldFiles>(FieldFiles{
          surface.mesh, std::move(folder), std::move(name), moving, surface_format, {}, 0, {}, {}})) {
  state_->begin(surface.places, restart_time);
}

FieldWriter::~FieldWriter() = default;

void FieldWriter::write(double time, std::span<const Vec3> points, const std::vector<OutputField>& fields) {
  if (!state_) return;
  FieldFiles& s = *state_;
  std::vector<Vec3> places;
  if (part_ && s.moving)
    for (const Index v : part_->points) places.push_back(points[v]);
  const std::string step = step_name(s.number);
  std::vector<xdmf::Field> listed;
  {
    hdf5::Handle id = hdf5::open_file_to_write(s.mesh.comm, s.file());
    hdf5::Handle group = hdf5::make_group(id, step);
    hdf5::write_attribute(group, "time", time);
    if (s.moving) s.write_points(id, step + "/coordinates", part_ ? places : points);
    std::vector<double> values;
    for (const OutputField& field : fields) {
      const bool on_cells = field.place == OutputField::Place::cells;
      const std::string path = fmt::format("{}/{}/{}", step, on_cells ? "cells" : "points", field.name);
      s.write_field(id, path,
                    part_ ? picked(field, on_cells ? part_->entries : part_->points, values) : field);
      const hdf5::Handle table = hdf5::open_written(id, path);
      const int components = field.components == 2 ? 3 : field.components;
      hdf5::write_attribute(table, "unit", field.unit);
      hdf5::write_attribute(table, "components", double(components));
      listed.push_back({field.name, field.unit, on_cells, components});
    }
    group.reset();
    hdf5::close_file(s.mesh.comm, id, s.file());
  }
  ++s.number;
  s.index.add(step, time, std::move(listed));
  if (parallel::comm_rank(s.mesh.comm) == 0) xdmf::write(s.folder / (s.name + ".xdmf"), s.index);
}

}  // namespace couplet::io
