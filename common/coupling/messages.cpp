// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/messages.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "common/base/error.hpp"
#include "common/coupling/step_plan.hpp"

namespace couplet::coupling {

namespace {

constexpr std::int64_t command_mark = 0x434f'4d4d;  // "COMM"
constexpr std::int64_t reply_mark = 0x5245'504c;    // "REPL"

/// Packs values of 8 bytes in the machine's byte order. Texts and arrays start with their length.
class Packer {
 public:
  void put(std::int64_t value) { raw(&value, sizeof value); }
  void put(double value) { raw(&value, sizeof value); }
  void put(const std::string& text) {
    put(std::int64_t(text.size()));
    raw(text.data(), text.size());
  }
  void put(const Vec3& point) { raw(point.data(), 3 * sizeof(double)); }
  /// Packs only names, since values are sent from rank to rank.
  void put(const Exchange& data) {
    put(std::int64_t(data.size()));
    for (const auto& [name, values] : data) put(name);
  }
  void put(const std::vector<GlobalIndex>& values) {
    put(std::int64_t(values.size()));
    raw(values.data(), values.size() * sizeof(GlobalIndex));
  }
  void put(const std::vector<std::string>& texts) {
    put(std::int64_t(texts.size()));
    for (const std::string& text : texts) put(text);
  }
  void put(const std::vector<Interface::Datum>& list) {
    put(std::int64_t(list.size()));
    for (const auto& datum : list) {
      put(datum.name);
      put(datum.unit);
      put(std::int64_t(datum.place));
      put(std::int64_t(datum.components));
    }
  }
  std::vector<char> take() { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    const char* first = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  std::vector<char> bytes_;
};

}  // namespace

const char* name(Op op) {
  constexpr std::array names{"initialise", "begin_step", "solve",    "accept_step", "write_output",
                             "save",       "load",       "finalise", "start"};
  static_assert(names.size() == std::size_t(Op::start));
  return names[std::size_t(op) - 1];
}

std::vector<char> pack(const Command& c) {
  Packer out;
  out.put(command_mark);
  out.put(protocol_version);
  out.put(std::int64_t(c.op));
  out.put(c.step.time);
  out.put(c.step.dt);
  out.put(std::int64_t(c.step.scheme));
  out.put(std::int64_t(c.step.number));
  out.put(std::int64_t(c.step.sub_steps));
  out.put(c.time);
  out.put(std::int64_t(c.output));
  out.put(c.folder);
  out.put(c.data);
  return out.take();
}

Command unpack_command(std::span<const char> bytes) {
  Unpacker in(bytes, command_mark, "command");
  Command c;
  c.op = Op(in.integer(1, 9, "the operation"));
  c.step.time = in.real();
  c.step.dt = in.real();
  c.step.scheme = Scheme(in.integer(0, 3, "the scheme"));
  c.step.number = in.integer(0, largest_integer, "the number of the step");
  c.step.sub_steps = int(in.integer(1, most_sub_steps, "the number of sub-steps"));
  c.time = in.real();
  c.output = int(in.integer(-1, std::numeric_limits<int>::max(), "the number of the output"));
  c.folder = in.text();
  c.data = in.exchange();
  in.finish();
  return c;
}

std::vector<char> pack(const Reply& r, const Partition& cut) {
  Packer out;
  out.put(reply_mark);
  out.put(protocol_version);
  out.put(std::int64_t(r.status));
  out.put(r.text);
  out.put(r.seconds);
  out.put(r.suggested_dt);
  out.put(r.report.dt);
  out.put(std::int64_t(r.report.iterations));
  out.put(r.report.error);
  out.put(r.report.energy);
  out.put(r.report.change);
  out.put(r.data);
  out.put(std::int64_t(r.interface.dim));
  out.put(std::int64_t(r.renewed));
  out.put(r.interface.takes);
  out.put(r.interface.gives);
  out.put(cut.vertices);
  out.put(cut.faces);
  return out.take();
}

namespace {

/// Extracts requests for values within the step: "datum@" beside "datum".
void take_out_within(std::vector<Interface::Datum>& takes, Surfaces& surfaces) {
  std::erase_if(takes, [&](const Interface::Datum& d) {
    if (!d.name.ends_with(WithinStep::mark)) return false;
    surfaces.within.insert(d.name.substr(0, d.name.size() - 1));
    surfaces.takes.erase(d.name);
    return true;
  });
  for (const std::string& name : surfaces.within)
    if (std::ranges::find(takes, name, &Interface::Datum::name) == takes.end())
      throw Error("A reply announces '{}{}' without '{}'.", name, WithinStep::mark, name);
}

}  // namespace

Reply unpack_reply(std::span<const char> bytes, Partition& cut) {
  Unpacker in(bytes, reply_mark, "reply");
  Reply r;
  r.status = Reply::Status(in.integer(0, 3, "the status"));
  r.text = in.text();
  r.seconds = in.real();
  r.suggested_dt = in.real();
  r.report.dt = in.real();
  r.report.iterations = long(in.integer(0, largest_integer, "the number of iterations"));
  r.report.error = in.real();
  r.report.energy = in.real();
  r.report.change = in.real();
  r.data = in.exchange();
  r.interface.dim = int(in.integer(2, 3, "the dimension"));
  r.renewed = in.integer(0, 1, "the flag for a recomputed reply") != 0;
  r.interface.takes = in.data(r.surfaces.takes);
  take_out_within(r.interface.takes, r.surfaces);
  r.interface.gives = in.data(r.surfaces.gives);
  cut.vertices = in.cut("vertices");
  cut.faces = in.cut("faces");
  in.finish();
  return r;
}

std::vector<Interface::Datum> present(const Exchange& data, const std::vector<Interface::Datum>& announced,
                                      const std::string& whose) {
  std::vector<Interface::Datum> list;
  for (const auto& [name, values] : data) {
    auto found = std::ranges::find(announced, name, &Interface::Datum::name);
    if (const auto within = found == announced.end() ? WithinStep::parse(name) : std::nullopt) {
      found = std::ranges::find(announced, within->first, &Interface::Datum::name);
      if (found != announced.end()) {
        list.push_back(*found);
        list.back().name = name;
        continue;
      }
    }
    if (found == announced.end())
      throw Error("'{}' is not a datum that '{}' announced at its interface.", name, whose);
    list.push_back(*found);
  }
  return list;
}

namespace {

template <class Value, class Data>
std::vector<std::span<Value>> stretches(Data& data, const std::vector<Interface::Datum>& of, int dim,
                                        const Slice& slice, const std::string& whose) {
  std::vector<std::span<Value>> parts;
  for (const auto& datum : of) {
    auto& array = data.at(datum.name);
    const bool at_vertices = datum.place == Interface::Place::vertices;
    const auto n = std::size_t(datum.size(dim));
    const std::size_t first = n * (at_vertices ? slice.first_vertex : slice.first_face),
                      count = n * (at_vertices ? slice.vertices : slice.faces);
    if (first + count > array.size())
      throw Error("'{}' gave {} values of '{}', but its interface has {} {} of {} components.", whose,
                  array.size(), datum.name, (first + count) / n, at_vertices ? "vertices" : "faces", n);
    if (count > 0) parts.emplace_back(array.data() + first, count);
  }
  return parts;
}

}  // namespace

std::vector<std::span<const double>> cut_out(const Exchange& data, const std::vector<Interface::Datum>& of,
                                             int dim, const Slice& slice, const std::string& whose) {
  return stretches<const double>(data, of, dim, slice, whose);
}

std::vector<std::span<double>> places_in(Exchange& data, const std::vector<Interface::Datum>& of, int dim,
                                         const Slice& slice, const std::string& whose) {
  return stretches<double>(data, of, dim, slice, whose);
}

// Layout: number, ids and positions of vertices; number, ids, centers, areas, numbers of vertices and
// their positions of faces; surfaces of the vertices, or none.
std::vector<char> cut_out(const Interface& i, const Slice& s) {
  Packer out;
  out.put(std::int64_t(s.vertices));
  for (std::size_t v = s.first_vertex; v < s.first_vertex + s.vertices; ++v) {
    out.put(i.vertex_ids.empty() ? std::int64_t(v) : std::int64_t(i.vertex_ids[v]));
    out.put(i.vertices[v]);
  }
  out.put(std::int64_t(s.faces));
  for (std::size_t f = s.first_face; f < s.first_face + s.faces; ++f) {
    out.put(i.face_ids.empty() ? std::int64_t(f) : std::int64_t(i.face_ids[f]));
    out.put(i.face_centres[f]);
    out.put(i.face_areas[f]);
    if (i.face_offset.empty()) {
      out.put(std::int64_t(0));
      continue;
    }
    out.put(std::int64_t(i.face_offset[f + 1] - i.face_offset[f]));
    for (Index k = i.face_offset[f]; k < i.face_offset[f + 1]; ++k)
      out.put(std::int64_t(i.face_vertices[std::size_t(k)]));
  }
  out.put(std::int64_t(0));  // our participants have no separate surfaces
  return out.take();
}

void put_back(std::span<const char> bytes, Interface& i, std::vector<int>& surface_of_vertex) {
  Unpacker in(bytes, "description of an interface");
  for (std::size_t n = in.count(4); n > 0; --n) {
    i.vertex_ids.push_back(in.integer());
    i.vertices.push_back(in.point("a vertex"));
  }
  if (i.face_offset.empty()) i.face_offset.push_back(0);
  constexpr std::int64_t most = std::numeric_limits<Index>::max();
  for (std::size_t n = in.count(8); n > 0; --n) {
    i.face_ids.push_back(in.integer());
    i.face_centres.push_back(in.point("a face"));
    i.face_areas.push_back(in.point("the area of a face"));
    for (std::size_t k = in.count(1); k > 0; --k)
      i.face_vertices.push_back(Index(in.integer(0, most, "a vertex of a face")));
    i.face_offset.push_back(Index(i.face_vertices.size()));
  }
  for (std::size_t n = in.count(1); n > 0; --n)
    surface_of_vertex.push_back(int(in.integer(0, most_surfaces, "the surface of a vertex")));
  in.finish();
}

}  // namespace couplet::coupling
