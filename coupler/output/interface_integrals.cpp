// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/parallel/collective.hpp"
#include "coupler/output/record.hpp"

namespace couplet::coupler {

namespace {

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

}  // namespace

InterfaceIntegrals::Integral InterfaceIntegrals::integral_of(const std::string& name,
                                                             const IntegralParameters& p, const Side& side,
                                                             const IntegratedSurface& surface) const {
  const Datum* datum = find(side.interface, p.data);
  if (!datum)
    throw Error("coupling.watch.{}.data: '{}' neither gives nor takes '{}'. Its data are: {}.", name,
                p.participant, p.data, names_of(side.interface));
  const int n = datum->size(side.interface.dim);
  Integral i{0, Kind::amount, *datum, side.entries(datum->place), std::size_t(n)};
  if (coupling::is_amount(*datum)) return i;
  i.places = side.entries(Place::faces);
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
    auto surface = std::ranges::find(surfaces_, index, &IntegratedSurface::side);
    if (surface == surfaces_.end())
      surface = surfaces_.insert(
          surface,
          IntegratedSurface{index, side->interface.dim, FaceCorners(comm, *side), moves(side->interface)});
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

std::vector<Vec3> InterfaceIntegrals::areas(const IntegratedSurface& s, const coupling::Exchange& given,
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
  for (std::size_t f = 0; f < i.places; ++f) {
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
    const IntegratedSurface& s = surfaces_[i.surface];
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
