// SPDX-License-Identifier: Apache-2.0
#include "fluid_solver/motion/obstacles.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace couplet::fluid {

namespace {

constexpr int most_trials = 60;
constexpr double root_found = 1e-14;  // of the edge

/// Share of an edge from the positive corner to the zero of the level. Uses false position with the Illinois
/// modification, else bisection; a linear level takes one trial.
double way(const LevelCorner& above, const LevelCorner& below, const Level& level, double round_off) {
  double low = 0, high = 1, at_low = above.level - round_off, at_high = below.level - round_off;
  for (int trial = 0; trial < most_trials && high - low > root_found; ++trial) {
    const bool halve = trial % 4 == 3;
    const double s = halve ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    const double there = level(above.place + s * (below.place - above.place)) - round_off;
    if (std::abs(there) <= root_found * above.level) return s;
    if (there > 0) {
      low = s, at_low = there;
      if (!halve) at_high /= 2;
    } else {
      high = s, at_high = there;
      if (!halve) at_low /= 2;
    }
  }
  return low;
}

// Shares this close to zero or one are round-off.
constexpr double smallest_cut = 1e-10;
// Likewise for levels relative to the cell size: faces along a surface are closed.
constexpr double level_round_off = 1e-10;
// Minimum distance of the open part's center from the surface, over cell size times open share.
constexpr double least_depth = 0.01;

double snapped(double share) { return share < smallest_cut ? 0 : share > 1 - smallest_cut ? 1 : share; }

/// Part of a face: a segment, or a triangle of a fan around its center.
template <int D>
using Piece = std::array<LevelCorner, D>;

template <int D>
double size_of(const Piece<D>& piece) {
  const Vec3 side = piece[1].place - piece[0].place;
  if constexpr (D == 2) return side.norm();
  if constexpr (D == 3) return side.cross(piece[2].place - piece[0].place).norm();
}

/// Volume of the simplex with its tip at `apex`, up to a constant factor.
template <int D>
double volume_of(const Piece<D>& piece, const Vec3& apex) {
  const Vec3 a = piece[0].place - apex, b = piece[1].place - apex;
  if constexpr (D == 2) return std::abs(a[0] * b[1] - a[1] * b[0]);
  if constexpr (D == 3) return std::abs(a.cross(b).dot(piece[2].place - apex));
}

template <int D, class Use>
void for_pieces(std::span<const Index> face, const LevelField& levels, const Use& use) {
  const auto corner = [&](Index v) { return LevelCorner{levels.points[v], levels.at_points[v]}; };
  if constexpr (D == 2) {
    use(Piece<2>{corner(face[0]), corner(face[1])});
  } else {
    LevelCorner middle;
    for (const Index v : face) middle.place += levels.points[v] / double(face.size());
    middle.level = levels.anywhere(middle.place);
    for (std::size_t i = 0; i < face.size(); ++i)
      use(Piece<3>{middle, corner(face[i]), corner(face[(i + 1) % face.size()])});
  }
}

/// Level range of a cell's corners, and sums over its simplices: volume, open volume, integral of the level.
struct Sums {
  double low = 0, high = 0, volume = 0, open = 0, moment = 0;
  bool passes = false;
};

template <int D>
class Cutter {
 public:
  Cutter(const mesh::Mesh& mesh, const Placement<D>& at, const LevelField& levels)
      : mesh_(mesh), at_(at), levels_(levels), sums_(mesh.cells.n_owned()) {}

  CutCells<D> make() {
    result_.faces.resize(mesh_.n_flux_faces());
    result_.wall.assign(mesh_.cells.n_local(), Vec<D>::Zero());
    find_corners();
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f) cut_face(f);
    mesh_.cells.update_ghosts(flat<D>(result_.wall), D);
    add_up();
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
      for_cells(f, [&](Index c, int) { result_.faces[f] *= result_.cells[c] > 0; });
    return std::move(result_);
  }

 private:
  template <class Use>
  void for_cells(Index f, const Use& use) const {
    use(mesh_.owner[f], 0);
    if (f < mesh_.n_interior) use(mesh_.neighbour[f], 1);
  }
  template <class Use>
  void for_owned(Index f, const Use& use) const {
    for_cells(f, [&](Index c, int side) {
      if (c < mesh_.cells.n_owned()) use(c, side);
    });
  }
  double round_off(Index c) const { return level_round_off * std::pow(at_.volume[c], 1.0 / D); }

  void find_corners() {
    for (std::size_t c = 0; c < sums_.size(); ++c) sums_[c].low = sums_[c].high = levels_.at_centres[c];
    for (Index f = 0; f < mesh_.n_flux_faces(); ++f)
      for_owned(f, [&](Index c, int) {
        for (const Index v : mesh_.face_points[f]) {
          sums_[c].low = std::min(sums_[c].low, levels_.at_points[v]);
          sums_[c].high = std::max(sums_[c].high, levels_.at_points[v]);
        }
      });
  }

  bool is_cut(Index c) const { return sums_[c].low <= round_off(c) && sums_[c].high > round_off(c); }

  void cut_face(Index f) {
    const double eps = round_off(mesh_.owner[f]);
    double low = levels_.at_points[mesh_.face_points[f][0]], high = low;
    for (const Index v : mesh_.face_points[f]) {
      low = std::min(low, levels_.at_points[v]);
      high = std::max(high, levels_.at_points[v]);
    }
    bool needed = low <= eps && high > eps;
    for_owned(f, [&](Index c, int) { needed |= is_cut(c); });
    double share = low > eps;
    if (needed) {
      double size = 0, open = 0;
      for_pieces<D>(mesh_.face_points[f], levels_, [&](const Piece<D>& piece) {
        size += size_of<D>(piece);
        open += size_of<D>(piece) * open_part(piece, levels_.anywhere, eps).share;
        for_owned(f, [&](Index c, int side) {
          add(piece, c, side == 0 ? Vec3(Vec3::Zero()) : mesh_.shift(f), eps);
        });
      });
      share = size > 0 ? snapped(open / size) : 0;
    }
    result_.faces[f] = share;
    for_owned(f, [&](Index c, int side) {
      result_.wall[c] += (side == 0 ? -1 : 1) * share * at_.area[f];
      sums_[c].passes |= share > 0;
    });
  }

  /// Adds the simplex of a piece and the cell center, relative to the face at `shift`.
  void add(const Piece<D>& piece, Index c, const Vec3& shift, double eps) {
    if (!is_cut(c)) return;
    LevelCorner apex{shift, levels_.at_centres[c]};
    apex.place.template head<D>() += at_.centre[c];
    std::array<LevelCorner, D + 1> corners;
    std::copy(piece.begin(), piece.end(), corners.begin());
    corners[D] = apex;
    const double volume = volume_of<D>(piece, apex.place);
    const OpenPart open = open_part(corners, levels_.anywhere, eps);
    sums_[c].volume += volume;
    sums_[c].open += volume * open.share;
    sums_[c].moment += volume * open.moment;
  }

  void add_up() {
    std::vector<std::array<double, 3>> all(mesh_.cells.n_local(), {0, 0, 0});  // share, depth, extent
    for (Index c = 0; c < mesh_.cells.n_owned(); ++c) {
      const Sums& s = sums_[c];
      const double centre = levels_.at_centres[c];
      double share = s.low > round_off(c);
      if (is_cut(c) && s.volume > 0) share = snapped(s.open / s.volume);
      if (!s.passes) share = 0;
      all[c] = {share, share == 1 ? centre : 0, std::max(s.high - centre, centre - s.low)};
      if (share > 0 && share < 1)
        all[c][1] = std::max(s.moment / s.open, least_depth * share * std::pow(at_.volume[c], 1.0 / D));
    }
    mesh_.cells.update_ghosts({all.empty() ? nullptr : all.front().data(), all.size() * 3}, 3);
    for (const auto& [share, depth, extent] : all) {
      result_.cells.push_back(share);
      result_.open_depth.push_back(depth);
      result_.extent.push_back(extent);
    }
  }

  const mesh::Mesh& mesh_;
  const Placement<D>& at_;
  const LevelField& levels_;
  std::vector<Sums> sums_;
  CutCells<D> result_;
};

}  // namespace

/// A single positive or non-positive corner gives a simplex there. A tetrahedron with two positive corners a,
/// b gives a prism of a, b and the points on the four other edges, split into three tetrahedra.
OpenPart open_part(std::span<const LevelCorner> corners, const Level& level, double round_off) {
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  const std::size_t n = corners.size();
  const auto is_above = [&](std::size_t i) { return corners[i].level > round_off; };
  const auto above =
      std::size_t(std::partition(order.begin(), order.begin() + std::ptrdiff_t(n), is_above) - order.begin());
  if (above == 0) return {};
  double mean = 0;
  for (const LevelCorner& c : corners) mean += c.level / double(n);
  if (above == n) return {1, mean};
  const auto at = [&](std::size_t i) { return corners[order[i]].level; };
  const auto between = [&](std::size_t i, std::size_t j) {
    return way(corners[order[i]], corners[order[j]], level, round_off);
  };
  if (above == 1) {
    double share = 1;
    for (std::size_t j = 1; j < n; ++j) share *= between(0, j);
    return {share, share * at(0) / double(n)};
  }
  if (above + 1 == n) {
    OpenPart open;
    double rest = 1, sum = mean * double(n) - at(above);
    for (std::size_t k = above; k-- > 0;) {
      const double along = between(k, above);
      open.share += along * rest;
      open.moment += along * rest * sum / double(n);
      rest *= 1 - along;
      sum -= at(k);
    }
    return open;
  }
  const double ac = between(0, 2), ad = between(0, 3), bc = between(1, 2), bd = between(1, 3);
  const std::array<double, 3> part{ac * ad, ad * bc * (1 - ac), bc * bd * (1 - ad)};
  return {part[0] + part[1] + part[2], (part[0] * (at(0) + at(1)) + (part[1] + part[2]) * at(1)) / 4};
}

template <int D>
CutCells<D> cut(const mesh::Mesh& mesh, const Placement<D>& at, const LevelField& levels) {
  return Cutter<D>(mesh, at, levels).make();
}

template CutCells<2> cut<2>(const mesh::Mesh&, const Placement<2>&, const LevelField&);
template CutCells<3> cut<3>(const mesh::Mesh&, const Placement<3>&, const LevelField&);

}  // namespace couplet::fluid
