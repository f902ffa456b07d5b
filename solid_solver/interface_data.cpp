// SPDX-License-Identifier: Apache-2.0
#include "solid_solver/interface_data.hpp"

#include <algorithm>

namespace couplet {

void declare(config::Section& s, InterfaceData& d) {
  using Load = InterfaceData::Load;
  s.choice("load", d.load, {{"forces", Load::forces}, {"pressure", Load::pressure}})
      .doc("taken at the faces: pressure-force and viscous-force, or one pressure");
  s.value("temperature", d.temperature)
      .doc("a temperature is taken at the faces; every point of the solid has that of the nearest face");
}

std::vector<Interface::Datum> taken(const InterfaceData& data) {
  using Place = Interface::Place;
  std::vector<Interface::Datum> list;
  if (data.load == InterfaceData::Load::pressure)
    list = {{"pressure", "Pa", Place::faces, 1}};
  else
    list = {{"pressure-force", "N", Place::faces}, {"viscous-force", "N", Place::faces}};
  if (data.temperature) list.push_back({"temperature", "K", Place::faces, 1});
  return list;
}

InterfaceTemperature::InterfaceTemperature(MPI_Comm comm, std::vector<Vec3> centres)
    : comm_(comm), centres_(std::move(centres)) {
  int n = static_cast<int>(centres_.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm_);
  centres_.resize(n);
  MPI_Bcast(centres_.data(), 3 * n, MPI_DOUBLE, 0, comm_);
}

std::vector<Index> InterfaceTemperature::nearest(std::span<const Vec3> points) const {
  std::vector<Index> found(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    double least = (points[i] - centres_.front()).squaredNorm();
    for (std::size_t k = 1; k < centres_.size(); ++k)
      if (const double d = (points[i] - centres_[k]).squaredNorm(); d < least)
        least = d, found[i] = static_cast<Index>(k);
  }
  return found;
}

std::vector<double> InterfaceTemperature::broadcast(std::vector<double> on_root) const {
  int n = static_cast<int>(on_root.size());
  MPI_Bcast(&n, 1, MPI_INT, 0, comm_);
  on_root.resize(n);
  MPI_Bcast(on_root.data(), n, MPI_DOUBLE, 0, comm_);
  return on_root;
}

}  // namespace couplet
