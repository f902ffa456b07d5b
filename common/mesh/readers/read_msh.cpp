// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/readers/read_msh.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>

#include "common/log/log.hpp"
#include "common/mesh/load.hpp"

namespace couplet::mesh {
namespace {

/// Names of physical groups by (dimension, tag), in the order of the file. The dimension is -1 if gmsh read a
/// file of version 2.0, which does not name it.
using MshNames = std::vector<std::pair<std::pair<int, int>, std::string>>;

/// Tag of a group without sign (negative if reversed). The smallest int has no counterpart and names no
/// group.
int msh_group(int tag) { return tag == std::numeric_limits<int>::min() ? tag : std::abs(tag); }

/// Numbers patches (or zones) for the physical groups of one dimension: names in the order of $PhysicalNames,
/// then unnamed groups as "physical_<tag>" in order of first use. Groups without elements are omitted.
class MshGroups {
 public:
  MshGroups(const MshNames& names, int dim) {
    for (const auto& [key, name] : names)
      if (key.first == dim || key.first < 0) number(key.second, name);
  }
  int use(int tag) {
    const auto found = number_of_tag_.find(tag);
    const int g =
        found != number_of_tag_.end() ? found->second : number(tag, fmt::format("physical_{}", tag));
    used_[g] = true;
    return g;
  }
  int use_default() {
    if (default_ < 0) default_ = number(0, "default");
    used_[default_] = true;
    return default_;
  }
  /// Removes unused names and renumbers `numbers`.
  std::vector<std::string> finish(std::vector<int>& numbers) const {
    std::vector<std::string> kept;
    std::vector<int> renumbered(names_.size(), -1);
    for (std::size_t g = 0; g < names_.size(); ++g) {
      if (!used_[g]) continue;
      renumbered[g] = static_cast<int>(kept.size());
      kept.push_back(names_[g]);
    }
    for (int& n : numbers) n = renumbered[n];
    return kept;
  }

  const std::string& name(int number) const { return names_[number]; }

 private:
  /// Number of a group. Two tags with the same name are one patch.
  int number(int tag, const std::string& name) {
    const auto same = std::find(names_.begin(), names_.end(), name);
    const int g = static_cast<int>(same - names_.begin());
    if (same == names_.end()) {
      names_.push_back(name);
      used_.push_back(false);
    }
    return number_of_tag_[tag] = g;
  }
  std::vector<std::string> names_;
  std::vector<bool> used_;
  std::map<int, int> number_of_tag_;
  int default_ = -1;
};

/// Nodes tag, tag + 1, ... are points index, index + 1, ...
struct NodeRun {
  std::size_t tag, count;
  GlobalIndex index;
  std::size_t place;  ///< in the file, behind the first tag
};

/// Consecutive elements of the file with one type and one elementary entity.
struct ElementRun {
  const MshType* type;
  int entity;  ///< tag of the curve, surface or volume; 0 if not named
  std::vector<int> groups;
  std::size_t count, place;  ///< in the file
  std::size_t head, bytes;   ///< number of values before its nodes; their size in a binary file
};

/// Reads the block of one rank from .msh 2.2 and 4.1, ASCII and binary. First scans the file for positions
/// and reads the points, then reads this rank's elements.
class MshReader {
 public:
  MshReader(const std::filesystem::path& file, int rank, int ranks) : rank_(rank), ranks_(ranks), in_(file) {
    read_format();
    bool has_nodes = false, has_elements = false;
    for (std::string section = in_.next_section(); !section.empty(); section = in_.next_section()) {
      has_nodes = has_nodes || section == "Nodes";
      has_elements = has_elements || section == "Elements";
      if (is_41_ && section == "PartitionedEntities")
        in_.fail("Partitioned meshes are not supported. Save the whole mesh; it is partitioned on loading.");
      if (section == "PhysicalNames")
        read_names();
      else if (is_41_ && section == "Entities")
        read_entities();
      else if (section == "Nodes")
        is_41_ ? read_nodes_41() : read_nodes_22();
      else if (section == "Elements")
        is_41_ ? find_elements_41() : find_elements_22();
      else {
        in_.skip_section();
        continue;
      }
      in_.end_section();
    }
    if (!has_nodes || !has_elements) in_.fail("The file has no $Nodes or no $Elements. It is incomplete.");
    block_.dim = has_dimension(3) ? 3 : 2;
  }

  bool has_dimension(int dim) const {
    return std::ranges::any_of(elements_,
                               [&](const ElementRun& e) { return e.type->dim == dim && e.count > 0; });
  }

  MeshBlock read() {
    make_cells();
    make_boundary();
    if (curved_ > 0 && rank_ == 0)
      log::info(
          "'{}': {} elements of second or higher order are reduced to their corners; compensate with about half "
          "the element size.",
          in_.file().string(), curved_);
    return std::move(block_);
  }

  /// Lists the entities of all boundary elements in the file.
  std::vector<int> boundary_entities() const {
    std::vector<int> entities;
    for (const ElementRun& e : elements_)
      if (e.type->dim == block_.dim - 1) entities.insert(entities.end(), e.count * e.groups.size(), e.entity);
    return entities;
  }

 private:
  void read_format() {
    std::string section = in_.at_end() ? "" : in_.next_section();
    for (; section == "Comments"; section = in_.next_section()) in_.skip_section();
    if (section != "MeshFormat")
      in_.fail("This is not a gmsh .msh file: it does not start with $MeshFormat.");
    const double version = in_.text_real();
    const long mode = in_.text_integer(), data_size = in_.text_integer();
    if (version != 2.2 && version != 4.1)
      in_.fail(fmt::format(
          "Version {} of the .msh format is not supported. Save the mesh as version 4.1 (gmsh -format msh41).",
          version));
    if (data_size != 8)
      in_.fail(fmt::format("Numbers of {} bytes are not supported; expected 8.", data_size));
    in_.line();
    if (mode == 1) {
      in_.binary = true;
      if (in_.raw<int>() != 1)
        in_.fail("The file was written on a machine with a different byte order. Save it as ASCII.");
    }
    in_.end_section();
    is_41_ = version == 4.1;
  }

  void read_names() {
    for (long n = in_.text_integer(); n > 0; --n) {
      const int dim = static_cast<int>(in_.text_integer()), tag = static_cast<int>(in_.text_integer());
      names_.push_back({{dim, tag}, in_.quoted()});
    }
  }

  void read_entities() {
    std::array<std::size_t, 4> counts{};
    for (std::size_t& n : counts) n = in_.count();
    for (int dim = 0; dim < 4; ++dim)
      for (std::size_t i = 0; i < counts[std::size_t(dim)]; ++i) {
        const int tag = in_.integer();
        for (int k = 0; k < (dim == 0 ? 3 : 6); ++k) in_.real();  // point or bounding box
        std::vector<int>& groups = groups_of_entity_[{dim, tag}];
        for (std::size_t n = in_.count(); n > 0; --n) groups.push_back(msh_group(in_.integer()));
        if (dim == 0) continue;
        in_.skip(in_.count(), sizeof(int));  // bounding entities
      }
  }

  void add_node(std::size_t tag, GlobalIndex index) {
    if (!nodes_.empty() && tag == nodes_.back().tag + nodes_.back().count)
      ++nodes_.back().count;
    else
      nodes_.push_back({tag, 1, index, in_.place()});
  }

  /// Reads or skips the coordinates and parameters of the next node, depending on this rank's share.
  void read_point(GlobalIndex index, int n_parameters) {
    if (index < first_point_ || index >= end_point_) return in_.skip(std::size_t(3 + n_parameters));
    Vec3 x;
    for (double& value : x) value = in_.real();
    block_.points.push_back(x);
    for (int k = 0; k < n_parameters; ++k) in_.real();
  }

  void share_points(std::size_t n) {
    block_.point_shares = {GlobalIndex(n), ranks_};
    first_point_ = block_.point_shares.first(rank_), end_point_ = block_.point_shares.first(rank_ + 1);
    block_.points.reserve(std::size_t(end_point_ - first_point_));
  }

  void sort_nodes() {
    std::ranges::stable_sort(nodes_, {}, &NodeRun::tag);
    for (std::size_t k = 1; k < nodes_.size(); ++k) {
      const NodeRun &one = nodes_[k - 1], &other = nodes_[k];
      if (other.tag >= one.tag + one.count) continue;
      in_.go_to(std::max(one.place, other.place), "Nodes");
      in_.fail(fmt::format("Duplicate node {}.", other.tag));
    }
  }

  void read_nodes_22() {
    const std::size_t n = in_.text_count();
    in_.line();
    share_points(n);
    for (std::size_t i = 0; i < n; ++i) {
      add_node(static_cast<std::size_t>(in_.integer()), GlobalIndex(i));
      read_point(GlobalIndex(i), 0);
    }
    const std::size_t end = in_.place();
    sort_nodes();
    in_.go_to(end, "Nodes");
  }

  void read_nodes_41() {
    const std::size_t n_blocks = in_.count(), total = in_.count();
    in_.skip(2);  // smallest and largest tag
    share_points(total);
    std::size_t next = 0;
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const int dim = in_.integer();
      in_.integer();  // entity
      const int n_parameters = in_.integer() != 0 ? std::clamp(dim, 0, 3) : 0;
      const std::size_t n = in_.count();
      for (std::size_t i = 0; i < n; ++i) add_node(in_.size(), GlobalIndex(next + i));
      for (std::size_t i = 0; i < n; ++i) read_point(GlobalIndex(next + i), n_parameters);
      next += n;
    }
    if (next != total)
      in_.fail(fmt::format("The file announces {} nodes, but its blocks have {}.", total, next));
    sort_nodes();
  }

  void find_elements_41() {
    const std::size_t n_blocks = in_.count();
    in_.skip(3);  // number of elements, smallest and largest tag
    for (std::size_t b = 0; b < n_blocks; ++b) {
      const int dim = in_.integer(), tag = in_.integer();
      const MshType& type = in_.type_or_fail(in_.integer());
      const std::size_t n = in_.count();
      const auto entity = groups_of_entity_.find({dim, tag});
      elements_.push_back({&type, tag, {}, n, in_.place(), 1, 8});
      if (entity != groups_of_entity_.end()) elements_.back().groups = entity->second;
      in_.skip(n * std::size_t(1 + type.n_nodes));
    }
  }

  void find_elements_22() {
    const std::size_t n = in_.text_count();
    in_.line();
    for (std::size_t done = 0; done < n;) {
      if (!in_.binary) {
        const std::size_t place = in_.place();
        in_.integer();  // number of the element
        const MshType& type = in_.type_or_fail(in_.integer());
        find_element_22(type, in_.integer(), place, 3, true);
        ++done;
        continue;
      }
      // Header for a run of elements of one type.
      const MshType& type = in_.type_or_fail(in_.integer());
      const int count = in_.integer(), n_tags = in_.integer();
      if (count < 1) in_.fail("A block of elements is empty.");
      for (int i = 0; i < count; ++i) {
        const std::size_t place = in_.place();
        in_.integer();  // number of the element
        find_element_22(type, n_tags, place, 1, i > 0);
      }
      done += static_cast<std::size_t>(count);
    }
  }

  /// Tags are the physical group (0 means none, a negative one is reversed), elementary entity, then partitions.
  void find_element_22(const MshType& type, int n_tags, std::size_t place, std::size_t head, bool follows) {
    ElementRun e{&type, 0, {}, 1, place, head + std::size_t(std::max(0, n_tags)), sizeof(int)};
    for (int t = 0; t < n_tags; ++t) {
      const int tag = in_.integer();
      if (t == 0 && tag != 0) e.groups.push_back(msh_group(tag));
      if (t == 1) e.entity = tag;
    }
    in_.skip(std::size_t(type.n_nodes), sizeof(int));
    ElementRun* last = elements_.empty() ? nullptr : &elements_.back();
    if (follows && last && last->type == e.type && last->head == e.head && last->entity == e.entity &&
        last->groups == e.groups)
      ++last->count;
    else
      elements_.push_back(std::move(e));
  }

  std::size_t tag_of_node(const ElementRun& e) {
    return in_.binary && e.bytes == sizeof(int) ? static_cast<std::size_t>(in_.raw<int>()) : in_.size();
  }

  GlobalIndex point_of(std::size_t tag) const {
    auto run = std::ranges::upper_bound(nodes_, tag, {}, &NodeRun::tag);
    if (run == nodes_.begin() || tag - std::prev(run)->tag >= std::prev(run)->count)
      in_.fail(fmt::format("An element uses node {}, which is not in $Nodes.", tag));
    --run;
    return run->index + GlobalIndex(tag - run->tag);
  }

  /// Moves to element `first` of the run.
  void go_to(const ElementRun& e, std::size_t first) {
    in_.go_to(e.place, "Elements");
    in_.skip(first * (e.head + std::size_t(e.type->n_nodes)), e.bytes);
  }

  void read_points_of(const ElementRun& e) {
    in_.skip(e.head, e.bytes);
    points_.clear();
    for (int i = 0; i < e.type->corners(); ++i) points_.push_back(point_of(tag_of_node(e)));
    in_.skip(std::size_t(e.type->n_nodes - e.type->corners()), e.bytes);
  }

  void make_cells() {
    MshGroups zones(names_, block_.dim);
    GlobalIndex total = 0;
    for (const ElementRun& e : elements_)
      if (e.type->dim == block_.dim) {
        total += GlobalIndex(e.count);
        if (e.type->n_nodes > e.type->corners()) curved_ += e.count;
      }
    block_.cell_shares = {total, ranks_};
    const GlobalIndex mine = block_.cell_shares.first(rank_), end = block_.cell_shares.first(rank_ + 1);
    GlobalIndex next = 0;
    for (const ElementRun& e : elements_) {
      if (e.type->dim != block_.dim || e.count == 0) continue;
      const int zone = e.groups.empty() ? zones.use_default() : zones.use(e.groups[0]);
      for (const int other : e.groups)
        if (zones.use(other) != zone)
          throw Error("{}: a {} is in two physical groups, '{}' and '{}'. A cell must be in exactly one.",
                      in_.file().string(), name_of(e.type->cell), zones.name(zone),
                      zones.name(zones.use(other)));
      const GlobalIndex after = next + GlobalIndex(e.count);
      const GlobalIndex first = std::clamp(mine, next, after), last = std::clamp(end, next, after);
      if (first < last) go_to(e, std::size_t(first - next));
      for (GlobalIndex c = first; c < last; ++c) {
        read_points_of(e);
        block_.push_cell(e.type->cell, zone, points_);
      }
      next = after;
    }
    block_.zones = zones.finish(block_.cells.zone);
  }

  /// Adds an element in two groups twice. The boundary check then reports both with their location.
  void make_boundary() {
    MshGroups patches(names_, block_.dim - 1);
    GlobalIndex total = 0;
    for (const ElementRun& e : elements_)
      if (e.type->dim == block_.dim - 1) total += GlobalIndex(e.count * e.groups.size());
    const Shares shares{total, ranks_};
    const GlobalIndex mine = shares.first(rank_), end = shares.first(rank_ + 1);
    GlobalIndex next = 0;
    for (const ElementRun& e : elements_) {
      if (e.type->dim != block_.dim - 1 || e.count == 0 || e.groups.empty()) continue;
      const auto copies = GlobalIndex(e.groups.size());
      const GlobalIndex after = next + GlobalIndex(e.count) * copies;
      std::vector<int> of_group;
      for (const int tag : e.groups) of_group.push_back(patches.use(tag));
      const GlobalIndex first = std::clamp(mine, next, after), last = std::clamp(end, next, after);
      if (first < last) go_to(e, std::size_t((first - next) / copies));
      for (GlobalIndex i = first; i < last; ++i) {
        if (i == first || (i - next) % copies == 0) read_points_of(e);
        block_.push_element(of_group[std::size_t((i - next) % copies)], points_);
      }
      next = after;
    }
    block_.patches = patches.finish(block_.element_patch);
  }

  int rank_, ranks_;
  MshCursor in_;
  bool is_41_ = false;
  MshNames names_;
  std::map<std::pair<int, int>, std::vector<int>> groups_of_entity_;
  std::vector<NodeRun> nodes_;
  std::vector<ElementRun> elements_;
  GlobalIndex first_point_ = 0, end_point_ = 0;
  std::vector<GlobalIndex> points_;  // of the last element read
  std::size_t curved_ = 0;
  MeshBlock block_;
};

/// Adds the boundary faces without an element as the patch `rest`.
void add_rest(RawMesh& raw) {
  std::set<std::vector<Index>> named;
  const auto key_of_face = [](std::span<const Index> points) {
    std::vector<Index> key(points.begin(), points.end());
    std::ranges::sort(key);
    return key;
  };
  for (Index e = 0; e < raw.boundary_points.size(); ++e) named.insert(key_of_face(raw.boundary_points[e]));
  const Csr outer = outer_faces(raw);
  for (Index f = 0; f < outer.size(); ++f) {
    if (named.contains(key_of_face(outer[f]))) continue;
    raw.boundary_points.push_row(outer[f]);
    raw.boundary_patch.push_back(rest_of(raw.patches));
  }
}

}  // namespace

RawMesh read_msh(const std::filesystem::path& file) {
  RawMesh raw = raw_of(MshReader(file, 0, 1).read());
  add_rest(raw);
  return raw;
}

bool is_converted(const std::filesystem::path& file) {
  MshCursor in(file);
  try {
    std::string section = in.next_section();
    for (; section == "Comments"; section = in.next_section()) in.skip_section();
    if (section != "MeshFormat") return section == "NOD";
    const double version = in.text_real();
    return version != 2.2 && version != 4.1;
  } catch (const Error&) {
    return false;  // the reader tells what is wrong
  }
}

MeshBlock read_msh_block(MPI_Comm comm, const std::filesystem::path& file, int holders) {
  const int rank = parallel::comm_rank(comm), ranks = parallel::comm_size(comm);
  MeshBlock block;
  on_all(comm, [&] {
    if (rank < holders) block = MshReader(file, rank, holders).read();
  });
  std::array<GlobalIndex, 3> counts{block.dim, block.point_shares.n, block.cell_shares.n};
  MPI_Bcast(counts.data(), 3, MPI_INT64_T, 0, comm);
  block.dim = static_cast<int>(counts[0]);
  block.point_shares = {counts[1], ranks, holders};
  block.cell_shares = {counts[2], ranks, holders};
  broadcast(comm, block.zones), broadcast(comm, block.patches);
  return block;
}

bool has_cells(const std::filesystem::path& file, int dim) {
  try {
    return MshReader(file, 0, 1).has_dimension(dim);
  } catch (const Error&) {
    return false;
  }
}

std::vector<int> read_boundary_entities(const std::filesystem::path& file) {
  return MshReader(file, 0, 1).boundary_entities();
}

}  // namespace couplet::mesh
