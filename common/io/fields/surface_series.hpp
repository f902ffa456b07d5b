// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io/fields/field_writer.hpp"
#include "common/mesh/mesh.hpp"

namespace couplet::io {

/// What is wrong with the list `output.surfaces`: patches, or the one word "all"; empty: nothing.
std::string wrong_surfaces(const std::vector<std::string>& names, const std::vector<std::string>& patches);

/// The same of patches that are keys.
template <class T>
std::string wrong_surfaces(const std::vector<std::string>& names,
                           const std::map<std::string, T>& of_patches) {
  std::vector<std::string> patches;
  for (const auto& [patch, unused] : of_patches) patches.push_back(patch);
  return wrong_surfaces(names, patches);
}

/// Time series of some patches, <folder>/surface-<patch>.h5 with .xdmf as FieldWriter makes them.
class SurfaceSeries {
 public:
  /// `places`: per local point of the body [m]. `names`: patches, or the one word "all". `body` by reference. Throws Error, which names `key`, for
  /// wrong_surfaces(). Collective.
  SurfaceSeries(const mesh::Mesh& body, std::span<const Vec3> places, const std::vector<std::string>& names,
                const std::string& key);
  ~SurfaceSeries();
  /// Where to write from now on; see FieldWriter.
  void open(std::filesystem::path folder, bool moving, double restart_time);

  const std::vector<const mesh::Patch*>& patches() const { return patches_; }
  /// Flags of the local points of the body on these patches, on all ranks that share them. Collective.
  std::vector<std::uint8_t> points() const;

  /// Of patches()[i]. `places`: per local point of the body. Of a field the place "cells" stands for the body's boundary
  /// faces, whose owned ones have a value at least; "points" for its local points. Collective.
  void write(std::size_t i, double time, std::span<const Vec3> places,
             const std::vector<OutputField>& fields);

 private:
  struct Surface;
  const mesh::Mesh& body_;
  std::vector<const mesh::Patch*> patches_;
  std::vector<std::unique_ptr<Surface>> surfaces_;  // one a patch
};

}  // namespace couplet::io
