// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/messages.hpp"

#include <algorithm>
#include <cstring>

#include "common/base/error.hpp"

namespace couplet {
namespace {

constexpr std::int64_t command_mark = 0x434f'4d4d;  // "COMM"
constexpr std::int64_t reply_mark = 0x5245'504c;    // "REPL"

/// Everything is 8 bytes wide, in the machine's order; texts and arrays carry their length first.
class Packer {
 public:
  void put(std::int64_t value) { raw(&value, sizeof value); }
  void put(double value) { raw(&value, sizeof value); }
  void put(const std::string& text) {
    put(std::int64_t(text.size()));
    raw(text.data(), text.size());
  }
  void put(const Vec3& point) { raw(point.data(), 3 * sizeof(double)); }
  /// Names alone: the values go from rank to rank.
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

class Unpacker {
 public:
  Unpacker(std::span<const char> bytes, const char* what) : bytes_(bytes), what_(what) {}
  Unpacker(std::span<const char> bytes, std::int64_t mark, const char* what) : Unpacker(bytes, what) {
    if (integer() != mark) throw Error("A message between programs is not the {} that was expected.", what_);
    const std::int64_t version = integer();
    if (version != protocol_version)
      throw Error(
          "A {} has protocol version {}, this program speaks version {}: use programs of one version.", what_,
          version, protocol_version);
  }
  std::int64_t integer() { return plain<std::int64_t>(); }
  double real() { return plain<double>(); }
  std::string text() {
    std::string value(length(1), '\0');
    raw(value.data(), value.size());
    return value;
  }
  Vec3 point() {
    Vec3 p;
    raw(p.data(), 3 * sizeof(double));
    return p;
  }
  std::vector<GlobalIndex> integers() {
    std::vector<GlobalIndex> values(length(sizeof(GlobalIndex)));
    raw(values.data(), values.size() * sizeof(GlobalIndex));
    return values;
  }
  std::vector<std::string> texts() {
    std::vector<std::string> list;
    for (std::int64_t n = integer(); n > 0; --n) list.push_back(text());
    return list;
  }
  Exchange exchange() {
    Exchange data;
    for (std::int64_t n = integer(); n > 0; --n) data[text()];
    return data;
  }
  std::vector<Interface::Datum> data() {
    std::vector<Interface::Datum> list;
    for (std::int64_t n = integer(); n > 0; --n) {
      Interface::Datum datum{text(), "", Interface::Place::vertices};
      datum.unit = text();
      datum.place = integer() == 0 ? Interface::Place::vertices : Interface::Place::faces;
      datum.components = static_cast<int>(integer());
      list.push_back(datum);
    }
    return list;
  }
  void finish() const {
    if (position_ != bytes_.size()) throw Error("A {} between programs is longer than its content.", what_);
  }

 private:
  template <class T>
  T plain() {
    T value;
    raw(&value, sizeof value);
    return value;
  }
  std::size_t length(std::size_t size_of_entry) {
    const std::int64_t n = integer();
    if (n < 0 || std::size_t(n) > (bytes_.size() - position_) / size_of_entry) truncated();
    return std::size_t(n);
  }
  void raw(void* to, std::size_t size) {
    if (size > bytes_.size() - position_) truncated();
    if (size > 0) std::memcpy(to, bytes_.data() + position_, size);
    position_ += size;
  }
  [[noreturn]] void truncated() const { throw Error("A {} between programs is cut short.", what_); }

  std::span<const char> bytes_;
  const char* what_;
  std::size_t position_ = 0;
};

}  // namespace

const char* name(Op op) {
  switch (op) {
    case Op::initialise:
      return "initialise";
    case Op::begin_step:
      return "begin_step";
    case Op::solve:
      return "solve";
    case Op::accept_step:
      return "accept_step";
    case Op::write_output:
      return "write_output";
    case Op::save:
      return "save";
    case Op::load:
      return "load";
    case Op::finalise:
      return "finalise";
  }
  return "unknown command";
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
  out.put(std::int64_t(c.step.waveform));
  out.put(c.time);
  out.put(std::int64_t(c.output));
  out.put(c.folder);
  out.put(c.data);
  return out.take();
}

Command unpack_command(std::span<const char> bytes) {
  Unpacker in(bytes, command_mark, "command");
  Command c;
  c.op = Op(in.integer());
  c.step.time = in.real();
  c.step.dt = in.real();
  c.step.scheme = Scheme(in.integer());
  c.step.number = in.integer();
  c.step.sub_steps = int(in.integer());
  c.step.waveform = in.integer() != 0;
  c.time = in.real();
  c.output = int(in.integer());
  c.folder = in.text();
  c.data = in.exchange();
  in.finish();
  return c;
}

std::vector<char> pack(const Reply& r, const Cut& cut) {
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
  out.put(r.data);
  out.put(std::int64_t(r.interface.dim));
  out.put(std::int64_t(r.anew));
  out.put(r.interface.parts);
  out.put(r.interface.takes);
  out.put(r.interface.gives);
  out.put(cut.vertices);
  out.put(cut.faces);
  return out.take();
}

Reply unpack_reply(std::span<const char> bytes, Cut& cut) {
  Unpacker in(bytes, reply_mark, "reply");
  Reply r;
  r.status = Reply::Status(in.integer());
  r.text = in.text();
  r.seconds = in.real();
  r.suggested_dt = in.real();
  r.report.dt = in.real();
  r.report.iterations = long(in.integer());
  r.report.error = in.real();
  r.report.energy = in.real();
  r.data = in.exchange();
  r.interface.dim = int(in.integer());
  r.anew = in.integer() != 0;
  r.interface.parts = in.texts();
  r.interface.takes = in.data();
  r.interface.gives = in.data();
  cut.vertices = in.integers();
  cut.faces = in.integers();
  in.finish();
  return r;
}

std::vector<Interface::Datum> present(const Exchange& data, const std::vector<Interface::Datum>& announced,
                                      const std::string& whose) {
  std::vector<Interface::Datum> list;
  for (const auto& [name, values] : data) {
    const auto found = std::ranges::find(announced, name, &Interface::Datum::name);
    if (found == announced.end())
      throw Error("'{}' is no datum that '{}' had announced at its interface.", name, whose);
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
      throw Error("'{}' gave {} values of '{}' where its interface has {} {} of {} components.", whose,
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

// Vertices: number, ids, places. Faces: number, ids, centres, areas, parts, numbers of vertices, their
// positions.
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
    out.put(std::int64_t(i.face_part.empty() ? 0 : i.face_part[f]));
    if (i.face_offset.empty()) {
      out.put(std::int64_t(0));
      continue;
    }
    out.put(std::int64_t(i.face_offset[f + 1] - i.face_offset[f]));
    for (Index k = i.face_offset[f]; k < i.face_offset[f + 1]; ++k)
      out.put(std::int64_t(i.face_vertices[std::size_t(k)]));
  }
  return out.take();
}

void put_back(std::span<const char> bytes, Interface& i) {
  Unpacker in(bytes, "description of an interface");
  for (std::int64_t n = in.integer(); n > 0; --n) {
    i.vertex_ids.push_back(in.integer());
    i.vertices.push_back(in.point());
  }
  if (i.face_offset.empty()) i.face_offset.push_back(0);
  for (std::int64_t n = in.integer(); n > 0; --n) {
    i.face_ids.push_back(in.integer());
    i.face_centres.push_back(in.point());
    i.face_areas.push_back(in.point());
    i.face_part.push_back(int(in.integer()));
    for (std::int64_t k = in.integer(); k > 0; --k) i.face_vertices.push_back(Index(in.integer()));
    i.face_offset.push_back(Index(i.face_vertices.size()));
  }
  in.finish();
}

}  // namespace couplet
