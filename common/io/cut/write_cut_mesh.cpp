// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/io/cut/cut_mesh_format.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/on_root.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {
namespace {

void check_names(const std::filesystem::path& file, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (name.size() > cut::longest_name)
      throw Error("Cannot write the cut mesh '{}': the name '{:.40}...' is longer than {} bytes.",
                  file.string(), name, cut::longest_name);
}

class CutMeshWriter {
 public:
  CutMeshWriter(MPI_Comm comm, hdf5::Handle& file) : comm_(comm), file_(file) {}

  /// `count` rows of `width` values each of this rank; the digest goes to the table.
  template <class T>
  void table(const char* name, std::span<const T> values, std::uint64_t width) {
    const hdf5::Rows rows = hdf5::distribute_rows(comm_, values.size() / width, width);
    hdf5::write_table(file_, name, rows, values.data());
    std::uint64_t digest = cut::digest_of(values, rows.first * width);
    MPI_Allreduce(MPI_IN_PLACE, &digest, 1, MPI_UINT64_T, MPI_SUM, comm_);
    const hdf5::Handle written = hdf5::open_written(file_, name);
    hdf5::write_attribute(written, "digest", fmt::format("{:016x}", digest));
  }
  void names(const std::string& kind, const std::vector<std::string>& names) {
    hdf5::write_attribute(file_, kind + "s", double(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i)
      hdf5::write_attribute(file_, fmt::format("{}-{}", kind, i), names[i]);
  }

 private:
  MPI_Comm comm_;
  hdf5::Handle& file_;
};

/// Of the box around all points. Collective.
Vec3 size_of(MPI_Comm comm, const std::vector<Vec3>& points) {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (const Vec3& x : points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  for (int a = 0; a < 3; ++a) low[a] = parallel::min(comm, low[a]), high[a] = parallel::max(comm, high[a]);
  return high - low;
}

/// Of all cells. Collective.
double shortest_edge(MPI_Comm comm, const mesh::MeshBlock& block) {
  const mesh::PointNumbers numbers(block.cells.points);
  const std::vector<Vec3> x =
      mesh::fetch(comm, block.point_shares, std::span<const Vec3>(block.points), numbers.numbers());
  double shortest = 1e300;
  for (Index c = 0; c < block.cells.size(); ++c) {
    const auto points = block.cells.points_of(c);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = i + 1; j < points.size(); ++j)
        shortest =
            std::min(shortest, (x[numbers.place(points[i])] - x[numbers.place(points[j])]).squaredNorm());
  }
  return std::sqrt(parallel::min(comm, shortest));
}

void write_cells(MPI_Comm comm, CutMeshWriter& to, const mesh::CellList& cells) {
  std::vector<std::int64_t> numbers;
  for (Index c = 0; c < cells.size(); ++c)
    numbers.push_back(std::int64_t(cells.type[c]) | std::int64_t(cells.zone[c]) << 8);
  to.table<std::int64_t>(cut::kind_table, numbers, 1);
  const GlobalIndex before = parallel::exclusive_scan(comm, GlobalIndex(cells.points.size()));
  numbers.clear();
  for (Index c = 0; c < cells.size(); ++c) numbers.push_back(before + cells.point_offset[c]);
  if (parallel::comm_rank(comm) == parallel::comm_size(comm) - 1)
    numbers.push_back(before + GlobalIndex(cells.points.size()));  // the end
  to.table<std::int64_t>(cut::first_table, numbers, 1);
  to.table<std::int64_t>(cut::cell_points_table, cells.points, 1);
}

void write_boundary(CutMeshWriter& to, const mesh::MeshBlock& block) {
  const std::uint64_t width = cut::element_width(block.dim);
  std::vector<std::int64_t> numbers;
  for (Index e = 0; e < block.n_elements(); ++e) {
    const auto points = block.element(e);
    numbers.insert(numbers.end(), points.begin(), points.end());
    numbers.insert(numbers.end(), width - points.size(), -1);
  }
  to.table<std::int64_t>(cut::element_points_table, numbers, width);
  numbers.assign(block.element_patch.begin(), block.element_patch.end());
  to.table<std::int64_t>(cut::element_patch_table, numbers, 1);
}

}  // namespace

void write_cut_mesh(MPI_Comm comm, const mesh::MeshBlock& block, const std::filesystem::path& file) {
  check_names(file, block.zones);
  check_names(file, block.patches);
  const std::filesystem::path part = file.string() + ".part";
  hdf5::Handle out = hdf5::create_file(comm, part);
  CutMeshWriter to(comm, out);
  hdf5::write_attribute(out, cut::version_name, cut::version);
  hdf5::write_attribute(out, cut::dimension_name, block.dim);
  const Vec3 size = size_of(comm, block.points);
  for (int a = 0; a < 3; ++a) hdf5::write_attribute(out, fmt::format("size-{}", "xyz"[a]), size[a]);
  hdf5::write_attribute(out, cut::edge_name, shortest_edge(comm, block));
  to.names("zone", block.zones);
  to.names("patch", block.patches);
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  to.table<double>(cut::points_table,
                   {block.points.empty() ? nullptr : block.points[0].data(), 3 * block.points.size()}, 3);
  write_cells(comm, to, block.cells);
  write_boundary(to, block);
  hdf5::close_file(out);
  mesh::on_root(comm, [&] { std::filesystem::rename(part, file); });
}

}  // namespace couplet::io
