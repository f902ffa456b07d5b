// SPDX-License-Identifier: Apache-2.0
#include "common/coupling/messages.hpp"

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
  void put(const std::vector<double>& values) {
    put(std::int64_t(values.size()));
    raw(values.data(), values.size() * sizeof(double));
  }
  void put(const std::vector<Vec3>& points) {
    put(std::int64_t(points.size()));
    for (const Vec3& p : points) raw(p.data(), 3 * sizeof(double));
  }
  void put(const std::vector<Index>& values) {
    put(std::int64_t(values.size()));
    for (const Index value : values) put(std::int64_t(value));
  }
  void put(const Exchange& data) {
    put(std::int64_t(data.size()));
    for (const auto& [name, values] : data) {
      put(name);
      put(values);
    }
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
  Unpacker(std::span<const char> bytes, std::int64_t mark, const char* what) : bytes_(bytes), what_(what) {
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
  std::vector<double> reals() {
    std::vector<double> values(length(sizeof(double)));
    raw(values.data(), values.size() * sizeof(double));
    return values;
  }
  std::vector<Vec3> points() {
    std::vector<Vec3> values(length(3 * sizeof(double)));
    for (Vec3& p : values) raw(p.data(), 3 * sizeof(double));
    return values;
  }
  std::vector<Index> indices() {
    std::vector<Index> values(length(sizeof(std::int64_t)));
    for (Index& value : values) value = static_cast<Index>(integer());
    return values;
  }
  Exchange exchange() {
    Exchange data;
    for (std::int64_t n = integer(); n > 0; --n) {
      const std::string name = text();
      data[name] = reals();
    }
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
  c.time = in.real();
  c.output = int(in.integer());
  c.folder = in.text();
  c.data = in.exchange();
  in.finish();
  return c;
}

std::vector<char> pack(const Reply& r) {
  Packer out;
  out.put(reply_mark);
  out.put(protocol_version);
  out.put(std::int64_t(r.status));
  out.put(r.text);
  out.put(r.seconds);
  out.put(r.suggested_dt);
  out.put(r.data);
  out.put(std::int64_t(r.interface.dim));
  out.put(std::int64_t(r.interface.closed));
  out.put(r.interface.vertices);
  out.put(r.interface.face_centres);
  out.put(r.interface.face_areas);
  out.put(r.interface.face_offset);
  out.put(r.interface.face_vertices);
  out.put(r.interface.takes);
  out.put(r.interface.gives);
  out.put(r.report.dt);
  out.put(std::int64_t(r.report.iterations));
  out.put(r.report.error);
  out.put(r.report.energy);
  return out.take();
}

Reply unpack_reply(std::span<const char> bytes) {
  Unpacker in(bytes, reply_mark, "reply");
  Reply r;
  r.status = Reply::Status(in.integer());
  r.text = in.text();
  r.seconds = in.real();
  r.suggested_dt = in.real();
  r.data = in.exchange();
  r.interface.dim = int(in.integer());
  r.interface.closed = in.integer() != 0;
  r.interface.vertices = in.points();
  r.interface.face_centres = in.points();
  r.interface.face_areas = in.points();
  r.interface.face_offset = in.indices();
  r.interface.face_vertices = in.indices();
  r.interface.takes = in.data();
  r.interface.gives = in.data();
  r.report.dt = in.real();
  r.report.iterations = long(in.integer());
  r.report.error = in.real();
  r.report.energy = in.real();
  in.finish();
  return r;
}

}  // namespace couplet
