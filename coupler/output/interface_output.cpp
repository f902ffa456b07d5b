// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/output/record.hpp"

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

using Datum = coupling::Interface::Datum;
using Place = coupling::Interface::Place;

const Datum* find(const coupling::Interface& interface, const std::string& name) {
  const Datum* given = find_datum(interface.gives, name);
  return given ? given : find_datum(interface.takes, name);
}

std::string names_of(const coupling::Interface& interface) {
  std::vector<std::string> names;
  for (const auto* list : {&interface.gives, &interface.takes})
    for (const Datum& datum : *list)
      if (std::ranges::find(names, datum.name) == names.end()) names.push_back(datum.name);
  return names.empty() ? "nothing" : base::join(names);
}

/// Data of this name that it gives, otherwise takes.
const std::vector<double>* either(const std::string& name, const coupling::Exchange& given,
                                  const coupling::Exchange& taken) {
  for (const coupling::Exchange* data : {&given, &taken})
    if (const auto found = data->find(name); found != data->end()) return &found->second;
  return nullptr;
}

bool moves(const coupling::Interface& interface) {
  const Datum* motion = find(interface, "displacement");
  return motion && motion->place == Place::vertices && motion->size(interface.dim) == interface.dim;
}

std::vector<bool> faces_of_part(MPI_Comm comm, const std::string& name, const IntegralParameters& p,
                                const coupling::Interface& interface) {
  std::vector<bool> counts(interface.face_centres.size(), true);
  if (p.part.empty()) return counts;
  const auto found = std::ranges::find(interface.parts, p.part);
  const int number = found == interface.parts.end() ? -1 : int(found - interface.parts.begin());
  for (std::size_t f = 0; f < counts.size(); ++f)
    counts[f] = number >= 0 && f < interface.face_part.size() && interface.face_part[f] == number;
  if (parallel::sum(comm, GlobalIndex(std::ranges::count(counts, true))) == 0)
    throw Error("coupling.watch.{}.part: the interface of '{}' has no part '{}'. Its parts are: {}.", name,
                p.participant, p.part,
                interface.parts.empty() ? "none with a name" : base::join(interface.parts));
  return counts;
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

InterfaceIntegrals::Integral InterfaceIntegrals::integral_of(const std::string& name,
                                                             const IntegralParameters& p, const Side& side,
                                                             const Surface& surface) const {
  const Datum* datum = find(side.interface, p.data);
  if (!datum)
    throw Error("coupling.watch.{}.data: '{}' neither gives nor takes '{}'. Its data are: {}.", name,
                p.participant, p.data, names_of(side.interface));
  const int n = datum->size(side.interface.dim);
  Integral i{0, Kind::amount, *datum, faces_of_part(comm_, name, p, side.interface), std::size_t(n)};
  if (coupling::is_amount(*datum)) {
    if (datum->place == Place::faces) return i;
    if (!p.part.empty())
      throw Error(
          "coupling.watch.{}.part: '{}' of '{}' is given at vertices, which belong to no part. Remove "
          "`part`.",
          name, p.data, p.participant);
    i.counts.assign(side.interface.vertices.size(), true);
    return i;
  }
  if (n != 1 && n != side.interface.dim)
    throw Error(
        "coupling.watch.{}.data: '{}' has {} components; only data with 1 or {} can be integrated over the "
        "surface.",
        name, p.data, n, side.interface.dim);
  if (datum->place == Place::vertices && !surface.corners.known())
    throw Error(
        "coupling.watch.{}.data: '{}' does not provide the corners of its faces, which the integral of '{}' "
        "needs. Watch the participant on the other side.",
        name, p.participant, p.data);
  i.kind = n == 1 ? Kind::scalar : Kind::flux;
  i.columns = n == 1 ? 2 : 1;
  return i;
}

InterfaceIntegrals::InterfaceIntegrals(MPI_Comm comm, const std::vector<Side>& sides,
                                       const std::map<std::string, IntegralParameters>& watched)
    : comm_(comm) {
  for (const auto& [name, p] : watched) {
    const auto side = std::ranges::find(sides, p.participant, &Side::name);
    if (side == sides.end())
      throw Error("coupling.watch.{}.participant: '{}' is not a participant of this coupling.", name,
                  p.participant);
    const auto index = std::size_t(side - sides.begin());
    auto surface = std::ranges::find(surfaces_, index, &Surface::side);
    if (surface == surfaces_.end())
      surface = surfaces_.insert(
          surface, Surface{index, side->interface.dim, FaceCorners(comm, *side), moves(side->interface)});
    integrals_.push_back(integral_of(name, p, *side, *surface));
    integrals_.back().surface = std::size_t(surface - surfaces_.begin());
    const Integral& i = integrals_.back();
    const std::string what = name + " " + p.data, &unit = i.datum.unit;
    const std::string times_area = unit == "m/s"  ? "m^3/s"
                                   : unit == "m"  ? "m^3"
                                   : unit.empty() ? "m^2"
                                                  : unit + " m^2";
    if (i.kind == Kind::amount)
      for (std::size_t c = 0; c < i.columns; ++c)
        columns_.push_back(
            fmt::format("{}{} [{}]", what, i.columns > 1 ? std::string(" ") + "xyz"[c % 3] : "", unit));
    else if (i.kind == Kind::flux)
      columns_.push_back(fmt::format("{} flux [{}]", what, times_area));
    else {
      columns_.push_back(fmt::format("{} integral [{}]", what, times_area));
      columns_.push_back(fmt::format("{} mean [{}]", what, unit));
    }
  }
}

std::vector<Vec3> InterfaceIntegrals::areas(const Surface& s, const coupling::Exchange& given,
                                            const coupling::Exchange& taken) const {
  const std::vector<double>* moved = s.moves ? either("displacement", given, taken) : nullptr;
  // Collective, because a rank without vertices does not have the datum.
  if (!s.corners.known() || !parallel::any(comm_, moved != nullptr)) return s.corners.reference_areas();
  return s.corners.areas(moved ? *moved : std::vector<double>{});
}

void InterfaceIntegrals::add_up(const Integral& i, const std::vector<double>& values,
                                const std::vector<Vec3>& areas, double* sums) const {
  const FaceCorners& corners = surfaces_[i.surface].corners;
  const auto n = std::size_t(i.datum.size(surfaces_[i.surface].dim));
  const bool at_corners = i.kind != Kind::amount && i.datum.place == Place::vertices;
  for (std::size_t f = 0; f < i.counts.size(); ++f) {
    if (!i.counts[f]) continue;
    Vec3 q = Vec3::Zero();
    const std::size_t from = at_corners ? std::size_t(corners.begin(f)) : f,
                      to = at_corners ? std::size_t(corners.end(f)) : f + 1;
    for (std::size_t k = from; k < to; ++k)
      for (std::size_t c = 0; c < std::min<std::size_t>(n, 3); ++c)
        q[Index(c)] += values[k * n + c] / double(to - from);
    if (i.kind == Kind::amount)
      for (std::size_t c = 0; c < n; ++c) sums[c] += values[f * n + c];
    else if (i.kind == Kind::flux)
      sums[0] += q.dot(areas[f]);
    else
      sums[0] += q.x() * areas[f].norm(), sums[1] += areas[f].norm();
  }
}

std::vector<double> InterfaceIntegrals::row(const std::vector<coupling::Exchange>& given,
                                            const std::vector<coupling::Exchange>& taken) const {
  std::vector<double> row(columns_.size(), 0);
  std::size_t column = 0;
  for (const Integral& i : integrals_) {
    const Surface& s = surfaces_[i.surface];
    const std::vector<double>* values = either(i.datum.name, given[s.side], taken[s.side]);
    const bool known = parallel::any(comm_, values != nullptr);
    if (known) {
      std::vector<double> here = values ? *values : std::vector<double>{};
      if (i.kind != Kind::amount && i.datum.place == Place::vertices)
        here = s.corners.values(here, i.datum.size(s.dim));
      const std::vector<Vec3> moved =
          i.kind == Kind::amount ? std::vector<Vec3>{} : areas(s, given[s.side], taken[s.side]);
      add_up(i, here, moved, row.data() + column);
      MPI_Allreduce(MPI_IN_PLACE, row.data() + column, int(i.columns), MPI_DOUBLE, MPI_SUM, comm_);
      if (i.kind == Kind::scalar) row[column + 1] = row[column] / row[column + 1];
    } else {
      std::fill_n(row.begin() + std::ptrdiff_t(column), i.columns, std::numeric_limits<double>::quiet_NaN());
    }
    column += i.columns;
  }
  return row;
}

}  // namespace couplet::coupler
