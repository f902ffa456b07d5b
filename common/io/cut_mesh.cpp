// SPDX-License-Identifier: Apache-2.0
#include "common/io/cut_mesh.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "common/base/error.hpp"
#include "common/io/hdf5.hpp"
#include "common/mesh/load.hpp"
#include "common/mesh/topology.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::io {

namespace {

namespace cut {

constexpr int version = 1;
constexpr const char *version_name = "cut-mesh-version", *dimension_name = "dimension",
                     *edge_name = "shortest-edge";
constexpr const char *points_table = "points", *kind_table = "cells/kind", *first_table = "cells/first",
                     *cell_points_table = "cells/points", *element_points_table = "boundary/points",
                     *element_patch_table = "boundary/patch";
constexpr std::size_t longest_name = 256;  // of zones and patches

/// Number of points of a boundary element; missing ones are -1.
std::uint64_t element_width(int dim) { return dim == 2 ? 2 : 4; }

/// Sum over the values of a table, each mixed with its position, so that ranks may add their sums.
template <class T>
std::uint64_t digest_of(std::span<const T> values, std::uint64_t first) {
  std::uint64_t sum = 0;
  for (const T& value : values) {
    std::uint64_t word = 0;
    static_assert(sizeof(T) == sizeof word);
    std::memcpy(&word, &value, sizeof word);
    word = (word ^ (++first * 0x9e3779b97f4a7c15ull)) * 0xff51afd7ed558ccdull;
    sum += (word ^ (word >> 32)) * 0xc4ceb9fe1a85ec53ull;
  }
  return sum;
}

}  // namespace cut

void check_names(const std::filesystem::path& file, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (name.size() > cut::longest_name)
      throw Error("Cannot write the cut mesh '{}': the name '{:.40}...' is longer than {} bytes.",
                  file.string(), name, cut::longest_name);
}

class CutMeshWriter {
 public:
  CutMeshWriter(MPI_Comm comm, hdf5::Handle& file) : comm_(comm), file_(file) {}

  /// Writes `count` rows of `width` values of this rank and stores the digest with the table.
  template <class T>
  void table(const char* name, std::span<const T> values, std::uint64_t width) {
    const hdf5::RowSpan rows = hdf5::distribute_rows(comm_, values.size() / width, width);
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

constexpr const char* cut_mesh = "cut mesh";
constexpr const char* advice_on_cut = "Write it again with 'couplet mesh cut'.";

/// Reads a whole number of at most `most` from an attribute.
std::uint64_t whole_number(const hdf5::Reader& in, const char* name, double most) {
  const double value = in.number("/", name);
  if (!(value >= 0) || value > most || value != std::floor(value))
    in.refuse(
        fmt::format("its attribute '{}' is {}; expected a whole number from 0 to {}", name, value, most));
  return static_cast<std::uint64_t>(value);
}

/// Opens a cut mesh of this version. Throws Error for any other file.
hdf5::Reader open_cut_mesh(const std::filesystem::path& file) {
  hdf5::Reader in(file, cut_mesh, advice_on_cut);
  if (!in.has_attribute("/", cut::version_name))
    in.refuse("it is an HDF5 file, but not a cut mesh (it has no 'cut-mesh-version')");
  const double version = in.number("/", cut::version_name);
  if (version != cut::version)
    in.refuse(fmt::format("it is of version {}; this program reads version {}", version, cut::version));
  return in;
}

std::vector<std::string> names_of(const hdf5::Reader& in, const std::string& kind) {
  constexpr double most = 100000;
  std::vector<std::string> names;
  const std::uint64_t n = whole_number(in, (kind + "s").c_str(), most);
  for (std::uint64_t i = 0; i < n; ++i)
    names.push_back(in.text("/", fmt::format("{}-{}", kind, i), cut::longest_name));
  return names;
}

/// Reads the block of one rank. Digests of its rows are summed over all ranks for comparison.
class CutMeshBlock {
 public:
  CutMeshBlock(const std::filesystem::path& file, int rank, int ranks)
      : in_(open_cut_mesh(file)), rank_(rank), ranks_(ranks) {}

  mesh::MeshBlock read() {
    block_.dim = whole_number(in_, cut::dimension_name, 3) == 2 ? 2 : 3;
    block_.zones = names_of(in_, "zone");
    block_.patches = names_of(in_, "patch");
    read_points();
    read_cells();
    read_boundary();
    return std::move(block_);
  }

  /// Name of a table that was read, digest of this rank's rows, and expected sum.
  struct Digest {
    const char* table;
    std::uint64_t here;
    std::string wanted;
  };
  std::vector<Digest> digests;

 private:
  template <class T>
  std::vector<T> rows(const char* table, std::uint64_t first, std::uint64_t count, std::uint64_t width) {
    std::vector<T> values(count * width);
    in_.read(table, {first, count, in_.rows(table, width), width}, values.data());
    return values;
  }
  template <class T>
  void add_digest(const char* table, std::span<const T> values, std::uint64_t first) {
    digests.push_back({table, cut::digest_of(values, first), in_.text(table, "digest", 16)});
  }

  void read_points() {
    block_.point_shares = {GlobalIndex(in_.rows(cut::points_table, 3)), ranks_};
    const auto first = std::uint64_t(block_.point_shares.first(rank_));
    const std::vector<double> x =
        rows<double>(cut::points_table, first, std::uint64_t(block_.point_shares.count(rank_)), 3);
    add_digest<double>(cut::points_table, x, 3 * first);
    for (std::size_t i = 0; i < x.size(); i += 3) block_.points.emplace_back(x[i], x[i + 1], x[i + 2]);
  }

  void read_cells() {
    mesh::CellList& cells = block_.cells;
    block_.cell_shares = {GlobalIndex(in_.rows(cut::kind_table, 1)), ranks_};
    const auto first = std::uint64_t(block_.cell_shares.first(rank_)),
               n = std::uint64_t(block_.cell_shares.count(rank_));
    const std::vector<std::int64_t> kinds = rows<std::int64_t>(cut::kind_table, first, n, 1);
    add_digest<std::int64_t>(cut::kind_table, kinds, first);
    const std::vector<std::int64_t> starts = rows<std::int64_t>(cut::first_table, first, n + 1, 1);
    const bool is_last = rank_ == ranks_ - 1;
    add_digest<std::int64_t>(cut::first_table, std::span(starts).first(n + (is_last ? 1 : 0)), first);
    for (std::uint64_t c = 0; c < n; ++c) {
      const auto type = kinds[c] & 0xff, zone = kinds[c] >> 8;
      if (type > std::int64_t(mesh::CellType::pyramid) || zone < 0 || zone >= std::ssize(block_.zones))
        in_.refuse(fmt::format("cell {} has an unknown type or zone", first + c));
      cells.type.push_back(mesh::CellType(type));
      cells.zone.push_back(static_cast<int>(zone));
      if (starts[c + 1] - starts[c] != mesh::shape_of(cells.type.back()).n_points)
        in_.refuse(fmt::format("cell {} does not have as many points as a {}", first + c,
                               mesh::name_of(cells.type.back())));
      cells.point_offset.push_back(cells.point_offset.back() + mesh::shape_of(cells.type.back()).n_points);
    }
    const auto from = std::uint64_t(starts.front());
    cells.points =
        rows<std::int64_t>(cut::cell_points_table, from, std::uint64_t(cells.point_offset.back()), 1);
    add_digest<std::int64_t>(cut::cell_points_table, cells.points, from);
    for (const GlobalIndex p : cells.points) check_point(p, "a cell");
  }

  void read_boundary() {
    const std::uint64_t width = cut::element_width(block_.dim);
    const mesh::Shares shares{GlobalIndex(in_.rows(cut::element_patch_table, 1)), ranks_};
    const auto first = std::uint64_t(shares.first(rank_)), n = std::uint64_t(shares.count(rank_));
    const std::vector<std::int64_t> patches = rows<std::int64_t>(cut::element_patch_table, first, n, 1),
                                    points = rows<std::int64_t>(cut::element_points_table, first, n, width);
    add_digest<std::int64_t>(cut::element_patch_table, patches, first);
    add_digest<std::int64_t>(cut::element_points_table, points, first * width);
    for (std::uint64_t e = 0; e < n; ++e) {
      if (patches[e] < 0 || patches[e] >= std::ssize(block_.patches))
        in_.refuse(fmt::format("boundary face {} has an unknown patch", first + e));
      std::span<const std::int64_t> element = std::span(points).subspan(e * width, width);
      if (width == 4 && element[3] == -1) element = element.first(3);
      for (const GlobalIndex p : element) check_point(p, "a boundary face");
      block_.push_element(static_cast<int>(patches[e]), element);
    }
  }

  void check_point(GlobalIndex p, const char* of) const {
    if (p < 0 || p >= block_.point_shares.n)
      in_.refuse(fmt::format("{} refers to point {}, but there are {}", of, p, block_.point_shares.n));
  }

  hdf5::Reader in_;
  int rank_, ranks_;
  mesh::MeshBlock block_;
};

}  // namespace

void write_cut_mesh(MPI_Comm comm, const mesh::MeshBlock& block, const std::filesystem::path& file) {
  check_names(file, block.zones);
  check_names(file, block.patches);
  const std::filesystem::path part = file.string() + ".part";
  hdf5::Handle out = hdf5::create_file(comm, part);
  CutMeshWriter to(comm, out);
  hdf5::write_attribute(out, cut::version_name, cut::version);
  hdf5::write_attribute(out, cut::dimension_name, block.dim);
  const mesh::MeshFacts facts = mesh::facts_of(comm, block);
  for (int a = 0; a < 3; ++a) hdf5::write_attribute(out, fmt::format("size-{}", "xyz"[a]), facts.size[a]);
  hdf5::write_attribute(out, cut::edge_name, facts.shortest_edge);
  to.names("zone", block.zones);
  to.names("patch", block.patches);
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  to.table<double>(cut::points_table,
                   {block.points.empty() ? nullptr : block.points[0].data(), 3 * block.points.size()}, 3);
  write_cells(comm, to, block.cells);
  write_boundary(to, block);
  hdf5::close_file(comm, out, part);
  parallel::on_root(comm, [&] { std::filesystem::rename(part, file); });
}

bool is_cut_mesh(const std::filesystem::path& file) { return file.extension() == ".h5"; }

mesh::MeshBlock read_cut_mesh(MPI_Comm comm, const std::filesystem::path& file) {
  mesh::MeshBlock block;
  std::vector<CutMeshBlock::Digest> digests;
  parallel::on_all(comm, [&] {
    CutMeshBlock reader(file, parallel::comm_rank(comm), parallel::comm_size(comm));
    block = reader.read();
    digests = reader.digests;
  });
  for (const CutMeshBlock::Digest& digest : digests) {
    std::uint64_t all = digest.here;
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_UINT64_T, MPI_SUM, comm);
    if (fmt::format("{:016x}", all) != digest.wanted)
      hdf5::Reader(file, cut_mesh, advice_on_cut)
          .refuse(fmt::format("the table '{}' is damaged: its digest differs", digest.table));
  }
  return block;
}

mesh::MeshFacts read_cut_mesh_facts(const std::filesystem::path& file) {
  const hdf5::Reader in = open_cut_mesh(file);
  mesh::MeshFacts facts;
  facts.dim = whole_number(in, cut::dimension_name, 3) == 2 ? 2 : 3;
  facts.cells = in.rows(cut::kind_table, 1);
  for (int a = 0; a < 3; ++a) facts.size[a] = in.number("/", fmt::format("size-{}", "xyz"[a]));
  facts.shortest_edge = in.number("/", cut::edge_name);
  facts.patches = names_of(in, "patch");
  facts.find_mean_cell();
  return facts;
}

mesh::LoadedMesh load_mesh(MPI_Comm comm, const std::filesystem::path& file, int dim,
                           const mesh::MeshParameters& parameters,
                           const std::vector<std::array<std::string, 2>>& periodic,
                           const std::vector<std::vector<std::string>>& materials, bool find_wide_points,
                           double scale, bool tie) {
  if (!is_cut_mesh(file))
    return mesh::load_mesh(comm, file, dim, parameters, periodic, materials, find_wide_points, scale, tie);
  if (!parameters.empty())
    throw Error(
        "The mesh '{}' is already meshed, so 'mesh-parameters' cannot change it. Remove them, or give the .geo it "
        "was made from.",
        file.string());
  mesh::MeshBlock block = read_cut_mesh(comm, file);
  if (block.dim != dim)
    throw Error("The mesh '{}' is {}-dimensional, but the case sets 'dimension: {}'.", file.string(),
                block.dim, dim);
  block.periodic = periodic;
  block.materials = materials;
  block.find_wide_points = find_wide_points;
  block.tie = tie;
  return mesh::load_block(comm, std::move(block), file, scale);
}

mesh::MeshFacts facts_of_file(const std::filesystem::path& file, const mesh::MeshParameters& parameters,
                              double scale) {
  if (!is_cut_mesh(file)) return mesh::facts_of_file(file, parameters, scale);
  mesh::MeshFacts facts = read_cut_mesh_facts(file);
  facts.scale(scale);
  return facts;
}

}  // namespace couplet::io
