// SPDX-License-Identifier: Apache-2.0
#include "plate_modal/model/plate_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace couplet::plate {
namespace {

/// Half of the thickness at each point.
std::vector<double> half_thickness(const PlateModel& plate) {
  const Midsurface& s = plate.surface();
  const std::vector<double> areas = plate.cell_areas();
  std::vector<double> sum(s.points.size(), 0), weight(s.points.size(), 0);
  for (Index c = 0; c < s.cells.size(); ++c)
    for (const Index p : s.cells[c]) sum[p] += areas[c] * plate.cell(c).thickness, weight[p] += areas[c];
  for (std::size_t p = 0; p < sum.size(); ++p) sum[p] /= 2 * weight[p];
  return sum;
}

/// Vertices of one side, numbered like the points of the mid-surface from `first` on, and its faces.
void add_side(const Midsurface& s, const PlateFrame& placement, const std::vector<double>& height,
              double sign, modes::ModalModel& model) {
  const Index first = static_cast<Index>(model.vertices.size());
  for (std::size_t p = 0; p < s.points.size(); ++p)
    model.vertices.push_back(placement.place(s.points[p], sign * height[p]));
  for (Index c = 0; c < s.cells.size(); ++c) {
    std::vector<Index> face;
    for (const Index p : s.cells[c]) face.push_back(first + p);
    if (sign < 0) std::ranges::reverse(face);
    model.faces.push_row(face);
  }
}

void add_rim(const Midsurface& s, const std::vector<bool>& open, modes::ModalModel& model) {
  const Index upper = 0, lower = static_cast<Index>(s.points.size());
  for (const auto& edge : s.edges)
    if (open[edge.patch])
      model.faces.push_row(
          std::array{lower + edge.from, lower + edge.to, upper + edge.to, upper + edge.from});
}

class Shapes {
 public:
  Shapes(const PlateModel& plate, const modes::EigenModes& modes, const PlateFrame& placement)
      : plate_(plate), placement_(placement), n_(modes.shape.size()) {
    for (const auto& shape : modes.shape) {
      points_.push_back(plate.to_points(shape));
      means_.push_back(plate.cell_means(points_.back()));
    }
  }
  void add_side(const std::vector<double>& height, double sign, modes::ModalModel& model) const {
    const std::size_t n_points = height.size(), first = model.vertex_shape.size();
    model.vertex_shape.resize(first + 3 * n_points * n_);
    for (std::size_t p = 0; p < n_points; ++p)
      for (std::size_t m = 0; m < n_; ++m) {
        const Vec3 u = motion(points_[m], p, sign * height[p]);
        for (int c = 0; c < 3; ++c) model.vertex_shape[first + (3 * p + c) * n_ + m] = u[c];
      }
  }
  /// Replaces the means of the corners by the exact mean deflection.
  void refine_side(Index first_face, modes::ModalModel& model) const {
    const Vec3 normal = placement_.normal();
    for (std::size_t c = 0; c < means_.front().size(); ++c)
      for (std::size_t m = 0; m < n_; ++m) {
        const std::size_t at = (std::size_t(first_face) + c) * 3 * n_ + m;
        Vec3 u(model.face_shape[at], model.face_shape[at + n_], model.face_shape[at + 2 * n_]);
        u += (means_[m][c] - u.dot(normal)) * normal;
        for (int d = 0; d < 3; ++d) model.face_shape[at + std::size_t(d) * n_] = u[d];
      }
  }
  std::vector<double> participation() const {
    const Vec3 normal = placement_.normal();
    const std::vector<double> areas = plate_.cell_areas();
    std::vector<double> result(3 * n_, 0);
    for (std::size_t c = 0; c < areas.size(); ++c)
      for (std::size_t m = 0; m < n_; ++m)
        for (int d = 0; d < 3; ++d)
          result[std::size_t(d) * n_ + m] +=
              normal[d] * plate_.cell(Index(c)).surface_density() * areas[c] * means_[m][c];
    return result;
  }

 private:
  Vec3 motion(const std::vector<double>& points, std::size_t p, double z) const {
    return points[3 * p] * placement_.normal() - z * points[3 * p + 1] * placement_.x -
           z * points[3 * p + 2] * placement_.y;
  }

  const PlateModel& plate_;
  const PlateFrame& placement_;
  std::size_t n_;
  std::vector<std::vector<double>> points_, means_;
};

}  // namespace

modes::ModalModel skin_of(const PlateModel& plate, const modes::EigenModes& modes,
                          const PlateFrame& placement, Wetted wetted, const std::vector<bool>& open) {
  const Midsurface& s = plate.surface();
  const std::vector<double> height = half_thickness(plate);
  const Shapes shapes(plate, modes, placement);
  modes::ModalModel model;
  for (const double value : modes.eigenvalue)
    model.frequency.push_back(std::sqrt(std::max(0., value)) / (2 * std::numbers::pi));
  std::vector<double> signs;
  if (wetted != Wetted::lower) signs.push_back(1);
  if (wetted != Wetted::upper) signs.push_back(-1);
  for (const double sign : signs) {
    add_side(s, placement, height, sign, model);
    shapes.add_side(height, sign, model);
  }
  if (wetted == Wetted::both) add_rim(s, open, model);
  modes::average_faces(model);
  for (std::size_t i = 0; i < signs.size(); ++i) shapes.refine_side(Index(i) * s.cells.size(), model);
  model.participation = shapes.participation();
  const std::vector<double> areas = plate.cell_areas();
  model.face_density.assign(model.faces.size(), 0);
  for (Index c = 0; c < s.cells.size(); ++c) {
    model.mass += plate.cell(c).surface_density() * areas[c];
    for (std::size_t i = 0; i < signs.size(); ++i)
      model.face_density[std::size_t(i) * s.cells.size() + c] =
          plate.cell(c).surface_density() / double(signs.size());
  }
  return model;
}

}  // namespace couplet::plate
