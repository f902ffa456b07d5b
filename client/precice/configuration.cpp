// SPDX-License-Identifier: Apache-2.0
#include "configuration.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "precice/Exceptions.hpp"

namespace couplet::dropin {
namespace {

using Element = pugi::xml_node;

std::string name(const Element& element) { return element.name(); }

/// Value of an attribute; empty if there is none.
std::string value(const Element& element, const char* attribute) {
  return element.attribute(attribute).value();
}

bool begins(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

bool is_true(const std::string& word) {
  return word == "true" || word == "1" || word == "yes" || word == "on";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "\"" : ", \"") + name + "\"";
  return text.empty() ? "none" : text;
}

/// Datum on its way from the writing to the reading participant.
struct Connection {
  std::string data, giver, from, taker, to;
  bool conservative = false, initialised = false, implicit = false, taker_is_early = false, sub_steps = true;
};

class Reader {
 public:
  Reader(const std::string& file, const std::string& participant) : xml_(file), root_(xml_.root()) {
    c_.file = file;
    c_.participant = participant;
  }

  Configuration read() {
    if (name(root_) != "precice-configuration")
      xml_.refuse(root_,
                  "expected <precice-configuration> of preCICE version 3, but found <" + name(root_) + ">.");
    if (is_true(value(root_, "allow-remeshing")))
      xml_.refuse(
          root_,
          "<precice-configuration> with allow-remeshing (meshes that change during the run) is not supported.");
    const Element me = participant(c_.participant);
    for (const Element child : root_.children())
      if (begins(name(child), "data:")) {
        is_vector_[value(child, "name")] = name(child) == "data:vector";
        degree_[value(child, "name")] = degree(child);
      }
    check_supported(me);
    c_.introduction = xml_.digest();
    meshes(me);
    data(me);
    for (const Element child : root_.children())
      if (begins(name(child), "coupling-scheme:")) scheme(child);
    wires();
    return std::move(c_);
  }

 private:
  /// Degree of the interpolation in time.
  int degree(const Element& datum) const {
    const std::string word = value(datum, "waveform-degree");
    if (word.empty()) return 1;
    if (word.size() > 2 || word.find_first_not_of("0123456789") != std::string::npos)
      xml_.refuse(datum, "waveform-degree of \"" + value(datum, "name") + "\" is \"" + word +
                             "\"; expected a whole number from 0 to 99.");
    return std::stoi(word);
  }

  Element participant(const std::string& wanted) const {
    std::vector<std::string> names;
    for (const Element p : root_.children("participant")) {
      if (value(p, "name") == wanted) return p;
      names.push_back(value(p, "name"));
    }
    throw ::precice::Error("The participant \"" + wanted + "\" is not defined in the preCICE configuration " +
                           c_.file + ". Defined participants are: " + listed(names) + ".");
  }

  void check_supported(const Element& me) const {
    for (const Element child : me.children()) {
      const std::string named = "<" + name(child) + ">";
      if (begins(name(child), "action:")) xml_.refuse(child, named + " (actions on data) is not supported.");
      if (name(child) == "use-mesh")
        xml_.refuse(child, named + " belongs to preCICE version 2, but this library reads version 3.");
      if (name(child) == "receive-mesh" &&
          (is_true(value(child, "api-access")) || is_true(value(child, "direct-access"))))
        xml_.refuse(child, named + " with api-access (direct access to received meshes) is not supported.");
      if (!begins(name(child), "mapping:")) continue;
      if (value(child, "from").empty() || value(child, "to").empty())
        xml_.refuse(child, named + " without from or to (just-in-time mapping) is not supported.");
      if (name(child).find("gradient") != std::string::npos)
        xml_.refuse(child, named + " (mapping with gradients) is not supported.");
      if (name(child).find("multiscale") != std::string::npos)
        xml_.refuse(child, named + " (mapping between dimensions) is not supported.");
      if (begins(value(child, "constraint"), "scaled"))
        xml_.refuse(child,
                    named + " with constraint \"" + value(child, "constraint") + "\" is not supported.");
    }
  }

  /// Returns true if a projection maps values consistently from this mesh or conservatively to it.
  bool projected(const std::string& mesh) const {
    for (const Element p : root_.children("participant"))
      for (const Element m : p.children("mapping:nearest-projection"))
        if (value(m, value(m, "constraint") == "conservative" ? "to" : "from") == mesh) return true;
    return false;
  }

  void meshes(const Element& me) {
    int dimensions = 0;
    for (const Element child : me.children()) {
      const bool provided = name(child) == "provide-mesh";
      if (!provided && name(child) != "receive-mesh") continue;
      const std::string mesh = value(child, "name");
      const Element found = root_.find_child_by_attribute("mesh", "name", mesh.c_str());
      if (!found) xml_.refuse(child, "there is no <mesh name=\"" + mesh + "\">.");
      const std::string size = value(found, "dimensions");
      if (size != "2" && size != "3")
        xml_.refuse(found, "dimensions of a mesh are \"2\" or \"3\", not \"" + size + "\".");
      c_.meshes.push_back({mesh, size == "2" ? 2 : 3, provided, provided && projected(mesh)});
      if (!provided) continue;
      if (dimensions == 0) dimensions = c_.meshes.back().dimensions;
      if (c_.meshes.back().dimensions != dimensions)
        xml_.refuse(child, "meshes of two and of three dimensions in one participant are not supported.");
    }
    if (dimensions == 0) xml_.refuse(me, "a participant that provides no mesh is not supported.");
  }

  void data(const Element& me) {
    for (const Element child : me.children()) {
      const bool written = name(child) == "write-data";
      if (!written && name(child) != "read-data") continue;
      const std::string datum = value(child, "name"), mesh = value(child, "mesh");
      if (!is_vector_.count(datum))
        xml_.refuse(child, "there is no <data:scalar> or <data:vector> with name \"" + datum + "\".");
      const Configuration::Mesh* used = c_.mesh(mesh);
      if (!used)
        xml_.refuse(child,
                    "\"" + c_.participant + "\" neither provides nor receives the mesh \"" + mesh + "\".");
      if (!used->provided)
        xml_.refuse(child, "reading or writing data on a received mesh (\"" + mesh +
                               "\") is not supported (direct access and just-in-time mapping).");
      c_.data.push_back({mesh, datum, is_vector_[datum], written});
    }
  }

  /// Meshes of `who` on which it writes (reads) a datum exchanged on `mesh`; true if mapped conservatively.
  std::map<std::string, bool> ends(const Element& who, const std::string& datum, const std::string& mesh,
                                   bool writes) const {
    std::map<std::string, bool> reached, found;
    for (const Element p : who.children("provide-mesh"))
      if (value(p, "name") == mesh) reached[mesh] = false;
    for (const Element m : who.children())
      if (begins(name(m), "mapping:") && value(m, "direction") == (writes ? "write" : "read") &&
          value(m, writes ? "to" : "from") == mesh)
        reached[value(m, writes ? "from" : "to")] = value(m, "constraint") == "conservative";
    for (const Element d : who.children(writes ? "write-data" : "read-data"))
      if (const auto end = reached.find(value(d, "mesh")); value(d, "name") == datum && end != reached.end())
        found.insert(*end);
    return found;
  }

  void scheme(const Element& s) {
    const bool serial = begins(name(s), "coupling-scheme:serial");
    const bool implicit = name(s).find("explicit") == std::string::npos;
    const Element pair = s.child("participants");
    const std::string first = value(pair, "first"), second = value(pair, "second");
    bool mine = first == c_.participant || second == c_.participant;
    for (const Element p : s.children("participant")) mine = mine || value(p, "name") == c_.participant;
    if (mine) {
      c_.implicit = c_.implicit || implicit;
      c_.introduction += std::string("\x1e") + (implicit ? "implicit" : "explicit") +
                         (serial && pair ? "\x1fserial\x1f" + first + "\x1f" + second : "\x1fparallel");
    }
    for (const Element w : s.children("time-window-size"))
      if (mine && value(w, "method") == "first-participant")
        xml_.refuse(w, "<time-window-size method=\"first-participant\"> is not supported.");
    for (const Element e : s.children("exchange")) {
      const std::string giver = value(e, "from"), taker = value(e, "to"), datum = value(e, "data");
      const auto starts = ends(participant(giver), datum, value(e, "mesh"), true);
      const auto stops = ends(participant(taker), datum, value(e, "mesh"), false);
      // Data that the receiver does not read serve only the convergence measures, which the coupler computes.
      const bool unread = !participant(taker).find_child_by_attribute("read-data", "name", datum.c_str());
      if ((starts.empty() && giver == c_.participant) ||
          (stops.empty() && !unread && taker == c_.participant))
        xml_.refuse(e, "no mapping of \"" + c_.participant + "\" leads \"" + datum + "\" on mesh \"" +
                           value(e, "mesh") + "\" to where it is read or written.");
      const bool sub_steps = value(e, "substeps").empty() || is_true(value(e, "substeps"));
      if (const int degree = degree_[datum]; degree > 1 && !sub_steps)
        xml_.refuse(e, "waveform-degree " + std::to_string(degree) + " of \"" + datum +
                           "\" needs its values at the sub-steps: substeps=\"true\".");
      for (const auto& [from, from_conservative] : starts)
        for (const auto& [to, to_conservative] : stops)
          connections_.push_back({datum, giver, from, taker, to, from_conservative || to_conservative,
                                  is_true(value(e, "initialize")), implicit, !serial || taker == first,
                                  sub_steps});
    }
  }

  void wires() {
    std::map<std::string, int> uses;
    for (const Connection& k : connections_) ++uses[k.data];
    for (const Connection& k : connections_) {
      const bool gives = k.giver == c_.participant;
      if (!gives && k.taker != c_.participant) continue;
      const auto* datum = c_.find(gives ? k.from : k.to, k.data, gives);
      if (!datum) continue;
      Configuration::Wire wire;
      wire.name = uses[k.data] == 1 ? k.data : k.data + " from " + k.from + " to " + k.to;
      wire.data = std::size_t(datum - c_.data.data());
      wire.given = gives;
      wire.conservative = k.conservative;
      wire.initialised = k.initialised;
      wire.held = !k.implicit && k.taker_is_early;
      wire.iterated = k.implicit && k.taker_is_early;
      wire.degree = degree_[k.data];
      wire.within = k.sub_steps && !wire.held;
      for (const auto& other : c_.wires)
        if (!gives && !other.given && other.data == wire.data)
          throw ::precice::Error(c_.file + ": \"" + k.data + "\" comes to mesh \"" + k.to +
                                 "\" from several participants or meshes, which is not supported.");
      c_.wires.push_back(wire);
    }
  }

  XmlFile xml_;
  Element root_;
  Configuration c_;
  std::map<std::string, bool> is_vector_;
  std::map<std::string, int> degree_;
  std::vector<Connection> connections_;
};

}  // namespace

const Configuration::Mesh* Configuration::mesh(const std::string& name) const {
  for (const Mesh& m : meshes)
    if (m.name == name) return &m;
  return nullptr;
}

const Configuration::Data* Configuration::find(const std::string& of, const std::string& name,
                                               bool is_written) const {
  for (const Data& d : data)
    if (d.mesh == of && d.name == name && d.written == is_written) return &d;
  return nullptr;
}

bool Configuration::writes_initial_data() const {
  return std::any_of(wires.begin(), wires.end(), [](const Wire& w) { return w.given && w.initialised; });
}

/// Finds the XML of an imported case, whose first lines contain its relative path.
static std::string configuration_of_case(const std::string& file) {
  const std::string mark = "# precice-config: ";
  std::ifstream in(file);
  if (!in) throw ::precice::Error("The configuration file \"" + file + "\" cannot be opened.");
  std::string line;
  for (int n = 0; n < 20 && std::getline(in, line); ++n)
    if (begins(line, mark))
      return (std::filesystem::path(file).parent_path() / line.substr(mark.size())).string();
  throw ::precice::Error(file +
                         ": this case does not name the preCICE configuration from which it was made (\"" +
                         mark + "...\", as couplet import writes it).");
}

Configuration read_configuration(const std::string& file, const std::string& participant) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const bool is_case = ending == ".yaml" || ending == ".yml";
  return Reader(is_case ? configuration_of_case(file) : file, participant).read();
}

}  // namespace couplet::dropin
