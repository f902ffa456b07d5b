// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "common/base/types.hpp"
#include "common/io/hdf5.hpp"

namespace couplet::testing {

/// A surface-<patch>.h5 whose faces are all of one kind, at its first output.
class SurfaceFile {
 public:
  SurfaceFile(const std::filesystem::path& folder, const std::string& patch)
      : file_(folder / ("surface-" + patch + ".h5"), "output"),
        n_(file_.rows("mesh/cell-id", 1)),
        n_points_(file_.rows("mesh/point-id", 1)),
        corners_(file_.number("/", "kind") == 2   ? 2
                 : file_.number("/", "kind") == 4 ? 3
                                                  : 4) {}

  bool has(const std::string& field) const { return file_.has(step_ + field); }
  std::size_t size() const { return n_; }
  /// "cells/traction", "points/displacement": row after row.
  std::vector<double> values(const std::string& field, std::uint64_t width = 1) const {
    const std::uint64_t n = field.starts_with("cells") ? n_ : n_points_;
    std::vector<double> values(n * width);
    file_.read(step_ + field, {0, n, n, width}, values.data());
    return values;
  }
  std::vector<Vec3> vectors(const std::string& field) const {
    const std::vector<double> flat = values(field, 3);
    std::vector<Vec3> rows;
    for (std::size_t i = 0; i < flat.size(); i += 3) rows.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    return rows;
  }
  /// Where the points are at the output, if they move, else where they were.
  std::vector<Vec3> points() const {
    std::vector<double> flat(3 * n_points_);
    const std::string moved = step_ + "coordinates";
    file_.read(file_.has(moved) ? moved : "mesh/coordinates", {0, n_points_, n_points_, 3}, flat.data());
    std::vector<Vec3> rows;
    for (std::size_t i = 0; i < flat.size(); i += 3) rows.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    return rows;
  }
  /// Numbers of the points of each face.
  std::vector<std::vector<std::size_t>> faces() const {
    std::vector<std::int64_t> flat(n_ * corners_);
    file_.read("mesh/cells", {0, n_, n_, corners_}, flat.data());
    std::vector<std::vector<std::size_t>> result(n_);
    for (std::size_t i = 0; i < flat.size(); ++i) result[i / corners_].push_back(std::size_t(flat[i]));
    return result;
  }
  std::vector<Vec3> centres() const {
    const std::vector<Vec3> at = points();
    std::vector<Vec3> result;
    for (const auto& face : faces()) {
      Vec3 sum = Vec3::Zero();
      for (const std::size_t v : face) sum += at[v];
      result.push_back(sum / double(face.size()));
    }
    return result;
  }
  /// [m^2]; of edges the length.
  std::vector<double> areas() const {
    const std::vector<Vec3> at = points();
    std::vector<double> result;
    for (const auto& face : faces()) {
      if (face.size() == 2) {
        result.push_back((at[face[1]] - at[face[0]]).norm());
        continue;
      }
      Vec3 area = Vec3::Zero();
      for (std::size_t i = 1; i + 1 < face.size(); ++i)
        area += 0.5 * (at[face[i]] - at[face[0]]).cross(at[face[i + 1]] - at[face[0]]);
      result.push_back(area.norm());
    }
    return result;
  }
  /// Sum of a vector of the faces times their areas.
  Vec3 integral(const std::string& field) const {
    const std::vector<double> area = areas();
    const std::vector<Vec3> rows = vectors(field);
    Vec3 total = Vec3::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) total += area[i] * rows[i];
    return total;
  }

 private:
  io::hdf5::Reader file_;
  std::uint64_t n_, n_points_, corners_;
  std::string step_ = "steps/000000/";
};

}  // namespace couplet::testing
