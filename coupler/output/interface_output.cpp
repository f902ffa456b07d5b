// SPDX-License-Identifier: Apache-2.0
#include "coupler/output/interface_output.hpp"

#include <cmath>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::coupler {
namespace {

namespace fs = std::filesystem;

void array(std::ostream& out, const std::string& name, const std::vector<double>& values, int components) {
  // ParaView requires three components for arrows and warps.
  const int shown = components == 2 ? 3 : components;
  out << fmt::format("<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">\n",
                     name, shown);
  for (std::size_t i = 0; i < values.size(); ++i) {
    out << fmt::format("{:.9g} ", values[i]);
    if (shown != components && (i + 1) % std::size_t(components) == 0) out << "0 ";
  }
  out << "\n</DataArray>\n";
}

void integers(std::ostream& out, const char* name, const std::vector<GlobalIndex>& values) {
  out << fmt::format("<DataArray type=\"Int64\" Name=\"{}\" format=\"ascii\">\n", name);
  for (const GlobalIndex v : values) out << v << ' ';
  out << "\n</DataArray>\n";
}

/// Entries "  <DataSet timestep="..." part="0" file="..."/>" of an earlier run up to this time.
std::vector<InterfaceFiles> kept(const fs::path& list, double restart_time) {
  std::vector<InterfaceFiles> files;
  if (std::isnan(restart_time)) return files;
  std::error_code ignored;
  if (!fs::exists(list, ignored)) return files;
  csv::LineReader in(list, "list of interface files", {.bytes = 1 << 30, .lines = 10000000});
  for (std::string_view line; in.next(line);) {
    const auto time = line.find("timestep=\""), part = line.find("part=\""), file = line.find("file=\"");
    if (time == std::string::npos || part == std::string::npos || file == std::string::npos) continue;
    const auto quoted = [&](std::size_t from) { return line.substr(from, line.find('"', from) - from); };
    const auto t = csv::number_of(quoted(time + 10));
    const std::string_view name = quoted(file + 6);  // "side-000001.0.vtp"
    const std::string end = fmt::format(".{}.vtp", quoted(part + 6));
    if (!t || !name.ends_with(end))
      throw Error("{}: this line is damaged. Move the list away; the files it names remain.", in.place());
    if (*t > restart_time * (1 + 1e-9)) continue;
    const std::string_view stem = name.substr(0, name.size() - end.size());
    if (!files.empty() && files.back().stem == stem)
      ++files.back().parts;
    else
      files.push_back({*t, std::string(stem), 1});
  }
  return files;
}

}  // namespace

InterfaceOutput::InterfaceOutput(MPI_Comm comm, fs::path folder, const std::vector<Side>& sides,
                                 double restart_time)
    : comm_(comm), folder_(std::move(folder)) {
  std::error_code failed;
  if (parallel::comm_rank(comm) == 0) fs::create_directories(folder_, failed);
  if (parallel::any(comm, bool(failed)))
    throw Error("Cannot create the folder {}: {}.", folder_.string(), failed.message());
  for (const Side& side : sides) {
    if (side.faces.back() == 0) continue;
    surfaces_.push_back({&side, std::size_t(&side - sides.data()), FaceCorners(comm, side),
                         kept(folder_ / (side.name + ".pvd"), restart_time)});
  }
}

void InterfaceOutput::write(double time, int number, const std::vector<coupling::Exchange>& given,
                            const std::vector<coupling::Exchange>& taken) {
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    Surface& surface = surfaces_[s];
    const std::string stem = fmt::format("{}-{:06d}", surface.side->name, number);
    write_piece(surface, folder_ / fmt::format("{}.{}.vtp", stem, parallel::comm_rank(comm_)),
                given[surface.index], taken[surface.index]);
    surface.files.push_back({time, stem, parallel::comm_size(comm_)});
    if (parallel::comm_rank(comm_) == 0) write_list(surface);
  }
}

void InterfaceOutput::write_piece(const Surface& surface, const fs::path& file,
                                  const coupling::Exchange& given, const coupling::Exchange& taken) const {
  const coupling::Interface& i = surface.side->interface;
  const std::size_t faces = i.face_centres.size();
  const bool has_corners = !i.face_vertices.empty();
  // Without known vertices, a face is represented by its center.
  std::vector<double> points;
  std::vector<GlobalIndex> connectivity, offsets;
  for (const Vec3& x : has_corners ? surface.corners.points() : i.face_centres)
    points.insert(points.end(), {x.x(), x.y(), x.z()});
  for (std::size_t k = 0; k < points.size() / 3; ++k) connectivity.push_back(GlobalIndex(k));
  for (std::size_t f = 0; f < faces; ++f)
    offsets.push_back(has_corners ? i.face_offset[f + 1] : GlobalIndex(f) + 1);
  const char* kind = !has_corners ? "Verts" : i.dim == 2 ? "Lines" : "Polys";
  std::ostringstream out;
  out << "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\">\n<PolyData>\n"
      << fmt::format("<Piece NumberOfPoints=\"{}\" NumberOf{}=\"{}\">\n<Points>\n", points.size() / 3, kind,
                     faces);
  array(out, "Points", points, 3);
  out << "</Points>\n<" << kind << ">\n";
  integers(out, "connectivity", connectivity);
  integers(out, "offsets", offsets);
  out << "</" << kind << ">\n";
  std::vector<std::pair<const coupling::Interface::Datum*, const std::vector<double>*>> data;
  for (const auto& [list, values] : {std::pair{&i.gives, &given}, std::pair{&i.takes, &taken}})
    for (const auto& datum : *list)
      if (const auto found = values->find(datum.name); found != values->end())
        data.emplace_back(&datum, &found->second);
  out << "<PointData>\n";
  for (const auto& [datum, values] : data)
    if (datum->place == coupling::Interface::Place::vertices && surface.side->faces.back() > 0)
      if (const auto at_corners = surface.corners.values(*values, datum->size(i.dim)); has_corners)
        array(out, datum->name, at_corners, datum->size(i.dim));
  out << "</PointData>\n<CellData>\n";
  for (const auto& [datum, values] : data)
    if (datum->place == coupling::Interface::Place::faces)
      array(out, datum->name, *values, datum->size(i.dim));
  out << "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
  base::write_file(file, out.view());
}

void InterfaceOutput::write_list(const Surface& surface) const {
  std::string text = "<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  for (const auto& [time, stem, parts] : surface.files)
    for (int r = 0; r < parts; ++r)
      text +=
          fmt::format("  <DataSet timestep=\"{:.12g}\" part=\"{}\" file=\"{}.{}.vtp\"/>\n", time, r, stem, r);
  base::write_file(folder_ / (surface.side->name + ".pvd"), text + "</Collection>\n</VTKFile>\n");
}

}  // namespace couplet::coupler
