// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/msh/msh_block.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "common/base/error.hpp"
#include "common/mesh/distributed/used_points.hpp"
#include "common/mesh/msh/msh_file.hpp"
#include "common/mesh/msh/msh_groups.hpp"
#include "common/mesh/msh/msh_window.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::mesh {
namespace {

// Runs of nodes whose numbers follow each other; with more of them the table of runs would be a mesh of its own.
constexpr std::size_t most_runs = 1 << 20;

/// Nodes tag, tag + 1, ... are points index, index + 1, ...
struct Run {
  std::uint64_t tag, count;
  GlobalIndex index;
};

/// Elements of one entity of the drawing.
struct Elements {
  int dim, type, n_nodes;
  std::vector<int> groups;
  std::uint64_t count, place;  ///< in the file
};

class MshBlockReader {
 public:
  MshBlockReader(MPI_Comm comm, const std::filesystem::path& file)
      : rank_(parallel::comm_rank(comm)), ranks_(parallel::comm_size(comm)), in_(file) {}

  MeshBlock read();

 private:
  void read_format();
  void read_names();
  void read_entities();
  void read_nodes();
  void find_elements();
  void skip_section(const std::string& name);
  GlobalIndex point_of(std::uint64_t tag) const;
  void read_points_of(const Elements& elements);
  void make_cells();
  void make_boundary();

  int rank_, ranks_;
  MshWindow in_;
  MshNames names_;
  std::map<std::pair<int, int>, std::vector<int>> groups_of_entity_;
  std::vector<Run> runs_;
  std::vector<Elements> elements_;
  std::vector<GlobalIndex> points_;  // of the element that was read last
  MeshBlock block_;
};

MeshBlock MshBlockReader::read() {
  if (in_.line() != "$MeshFormat") in_.fail();
  read_format();
  while (!in_.at_end()) {
    const std::string section = in_.line();
    if (section.empty()) continue;
    if (section == "$PhysicalNames")
      read_names();
    else if (section == "$Entities")
      read_entities();
    else if (section == "$Nodes")
      read_nodes();
    else if (section == "$Elements")
      find_elements();
    else
      skip_section(section);
  }
  if (runs_.empty() || elements_.empty()) in_.fail();
  make_cells();
  make_boundary();
  return std::move(block_);
}

void MshBlockReader::read_format() {
  if (in_.text_real() != 4.1) in_.fail();
  in_.binary = in_.text_integer() == 1;
  if (in_.text_integer() != 8) in_.fail();
  in_.line();
  if (in_.binary && in_.raw<int>() != 1) in_.fail();
  skip_section("$MeshFormat");
}

/// To behind its end; what is left of it is text.
void MshBlockReader::skip_section(const std::string& name) {
  if (name.front() != '$' || name == "$PartitionedEntities") in_.fail();
  const std::string end = "$End" + name.substr(1);
  while (!in_.at_end())
    if (in_.line() == end) return;
  in_.fail();
}

void MshBlockReader::read_names() {
  for (std::int64_t n = in_.text_integer(); n > 0; --n) {
    const int dim = static_cast<int>(in_.text_integer()), tag = static_cast<int>(in_.text_integer());
    const std::string text = in_.line();
    const std::size_t first = text.find('"'), last = text.rfind('"');
    if (first == std::string::npos || last == first) in_.fail();
    names_.push_back({{dim, tag}, text.substr(first + 1, last - first - 1)});
  }
  skip_section("$PhysicalNames");
}

void MshBlockReader::read_entities() {
  std::array<std::uint64_t, 4> counts{};
  for (std::uint64_t& n : counts) n = in_.size();
  for (int dim = 0; dim < 4; ++dim)
    for (std::uint64_t i = 0; i < counts[std::size_t(dim)]; ++i) {
      std::vector<int>& groups = groups_of_entity_[{dim, in_.integer()}];
      in_.skip(dim == 0 ? 3 : 6);
      for (std::uint64_t n = in_.size(); n > 0; --n) groups.push_back(msh_group(in_.integer()));
      if (dim == 0) continue;
      for (std::uint64_t n = in_.size(); n > 0; --n) in_.integer();
    }
  skip_section("$Entities");
}

void MshBlockReader::read_nodes() {
  const std::uint64_t blocks = in_.size(), total = in_.size();
  in_.skip(2);
  block_.point_shares = {GlobalIndex(total), ranks_};
  const GlobalIndex mine = block_.point_shares.first(rank_), end = block_.point_shares.first(rank_ + 1);
  GlobalIndex next = 0;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const int dim = in_.integer();
    in_.integer();
    const int more = in_.integer() != 0 ? dim : 0;
    const auto n = GlobalIndex(in_.size());
    if (n < 0 || next + n > GlobalIndex(total)) in_.fail();
    for (GlobalIndex i = 0; i < n; ++i) {
      const std::uint64_t tag = in_.size();
      if (!runs_.empty() && tag == runs_.back().tag + runs_.back().count)
        ++runs_.back().count;
      else
        runs_.push_back({tag, 1, next + i});
    }
    if (runs_.size() > most_runs) in_.fail();
    const GlobalIndex first = std::clamp(mine, next, next + n), last = std::clamp(end, next, next + n);
    in_.skip(std::uint64_t(first - next) * std::uint64_t(3 + more));
    for (GlobalIndex i = first; i < last; ++i) {
      Vec3 x;
      for (double& value : x) value = in_.real();
      block_.points.push_back(x);
      in_.skip(std::uint64_t(more));
    }
    in_.skip(std::uint64_t(next + n - last) * std::uint64_t(3 + more));
    next += n;
  }
  if (next != GlobalIndex(total)) in_.fail();
  std::ranges::sort(runs_, {}, &Run::tag);
  for (std::size_t k = 1; k < runs_.size(); ++k)
    if (runs_[k].tag < runs_[k - 1].tag + runs_[k - 1].count) in_.fail();
  skip_section("$Nodes");
}

void MshBlockReader::find_elements() {
  const std::uint64_t blocks = in_.size();
  in_.skip(3);
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const int dim = in_.integer(), tag = in_.integer();
    const MshElementType* type = find_msh_type(in_.integer());
    if (!type || type->dim != dim) in_.fail();
    const std::uint64_t n = in_.size();
    const auto entity = groups_of_entity_.find({dim, tag});
    elements_.push_back({dim, type->gmsh, type->n_nodes, {}, n, in_.place()});
    if (entity != groups_of_entity_.end()) elements_.back().groups = entity->second;
    in_.skip(n * std::uint64_t(1 + type->n_nodes));
  }
  skip_section("$Elements");
}

GlobalIndex MshBlockReader::point_of(std::uint64_t tag) const {
  auto run = std::ranges::upper_bound(runs_, tag, {}, &Run::tag);
  if (run == runs_.begin() || tag - std::prev(run)->tag >= std::prev(run)->count) in_.fail();
  --run;
  return run->index + GlobalIndex(tag - run->tag);
}

void MshBlockReader::read_points_of(const Elements& elements) {
  in_.skip(1);
  points_.clear();
  for (int i = 0; i < elements.n_nodes; ++i) points_.push_back(point_of(in_.size()));
}

void MshBlockReader::make_cells() {
  block_.dim = std::ranges::any_of(elements_, [](const Elements& e) { return e.dim == 3; }) ? 3 : 2;
  MshGroups zones(names_, block_.dim);
  GlobalIndex total = 0;
  for (const Elements& e : elements_)
    if (e.dim == block_.dim) total += GlobalIndex(e.count);
  block_.cell_shares = {total, ranks_};
  const GlobalIndex mine = block_.cell_shares.first(rank_), end = block_.cell_shares.first(rank_ + 1);
  GlobalIndex next = 0;
  for (const Elements& e : elements_) {
    if (e.dim != block_.dim || e.count == 0) continue;
    const int zone = e.groups.empty() ? zones.use_default() : zones.use(e.groups[0]);
    for (const int other : e.groups)
      if (zones.use(other) != zone) in_.fail();
    const GlobalIndex after = next + GlobalIndex(e.count);
    const GlobalIndex first = std::clamp(mine, next, after), last = std::clamp(end, next, after);
    if (first < last) {
      in_.go_to(e.place);
      in_.skip(std::uint64_t(first - next) * std::uint64_t(1 + e.n_nodes));
    }
    for (GlobalIndex c = first; c < last; ++c) {
      read_points_of(e);
      block_.push_cell(msh_cell_type(e.type), zone, points_);
    }
    next = after;
  }
  block_.zones = zones.finish(block_.cells.zone);
}

/// An element in two groups stands there twice, as in read_msh().
void MshBlockReader::make_boundary() {
  MshGroups patches(names_, block_.dim - 1);
  GlobalIndex total = 0;
  for (const Elements& e : elements_)
    if (e.dim == block_.dim - 1) total += GlobalIndex(e.count * e.groups.size());
  const Shares shares{total, ranks_};
  const GlobalIndex mine = shares.first(rank_), end = shares.first(rank_ + 1);
  GlobalIndex next = 0;
  for (const Elements& e : elements_) {
    if (e.dim != block_.dim - 1 || e.count == 0 || e.groups.empty()) continue;
    const auto copies = GlobalIndex(e.groups.size());
    const GlobalIndex after = next + GlobalIndex(e.count) * copies;
    std::vector<int> of_group;
    for (const int tag : e.groups) of_group.push_back(patches.use(tag));
    const GlobalIndex first = std::clamp(mine, next, after), last = std::clamp(end, next, after);
    if (first < last) {
      in_.go_to(e.place);
      in_.skip(std::uint64_t((first - next) / copies) * std::uint64_t(1 + e.n_nodes));
    }
    for (GlobalIndex i = first; i < last; ++i) {
      if (i == first || (i - next) % copies == 0) read_points_of(e);
      block_.push_element(of_group[std::size_t((i - next) % copies)], points_);
    }
    next = after;
  }
  block_.patches = patches.finish(block_.element_patch);
}

}  // namespace

std::optional<MeshBlock> read_msh_block(MPI_Comm comm, const std::filesystem::path& file) {
  std::optional<MeshBlock> block;
  try {
    block = MshBlockReader(comm, file).read();
  } catch (const Error&) {
    // read_msh() says what is wrong, if anything is.
  }
  if (parallel::any(comm, !block)) return {};
  drop_unused_points(comm, *block);
  return block;
}

}  // namespace couplet::mesh
