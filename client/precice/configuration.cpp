// SPDX-License-Identifier: Apache-2.0
#include "configuration.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "precice/Exceptions.hpp"

namespace couplet::dropin {
namespace {

[[noreturn]] void refuse(const std::string& file, const Element& e, const std::string& why) {
  throw ::precice::Error(file + ":" + std::to_string(e.line) + ": " + why);
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
  Reader(const std::string& file, const std::string& participant) : root_(read_xml(file)) {
    c_.file = file;
    c_.participant = participant;
  }

  Configuration read() {
    if (root_.name != "precice-configuration")
      refuse(c_.file, root_,
             "<precice-configuration> of preCICE's version 3 is expected, this is <" + root_.name + ">.");
    if (is_true(root_.attribute("allow-remeshing")))
      refuse(
          c_.file, root_,
          "<precice-configuration> with allow-remeshing is not supported: meshes that change during the run.");
    const Element& me = participant(c_.participant);
    for (const Element& child : root_.children)
      if (begins(child.name, "data:")) {
        is_vector_[child.attribute("name")] = child.name == "data:vector";
        degree_[child.attribute("name")] = degree(child);
      }
    check_supported(me);
    c_.introduction = digest(root_);
    meshes(me);
    data(me);
    for (const Element& child : root_.children)
      if (begins(child.name, "coupling-scheme:")) scheme(child);
    wires();
    return std::move(c_);
  }

 private:
  /// Degree of the interpolation in time.
  int degree(const Element& datum) const {
    const std::string word = datum.attribute("waveform-degree");
    if (word.empty()) return 1;
    if (word.size() > 2 || word.find_first_not_of("0123456789") != std::string::npos)
      refuse(c_.file, datum,
             "waveform-degree of \"" + datum.attribute("name") + "\" is \"" + word +
                 "\"; expected a whole number from 0 to 99.");
    return std::stoi(word);
  }

  const Element& participant(const std::string& name) const {
    std::vector<std::string> names;
    for (const Element* p : root_.all("participant")) {
      if (p->attribute("name") == name) return *p;
      names.push_back(p->attribute("name"));
    }
    throw ::precice::Error("The participant \"" + name + "\" is not defined in the preCICE configuration " +
                           c_.file + ". Defined participants are: " + listed(names) + ".");
  }

  void check_supported(const Element& me) const {
    for (const Element& child : me.children) {
      const std::string named = "<" + child.name + ">";
      if (begins(child.name, "action:"))
        refuse(c_.file, child, named + " is not supported: actions on data.");
      if (child.name == "use-mesh")
        refuse(c_.file, child, named + " is of preCICE's version 2; this library reads version 3.");
      if (child.name == "receive-mesh" &&
          (is_true(child.attribute("api-access")) || is_true(child.attribute("direct-access"))))
        refuse(c_.file, child,
               named + " with api-access is not supported: direct access to received meshes.");
      if (!begins(child.name, "mapping:")) continue;
      if (child.attribute("from").empty() || child.attribute("to").empty())
        refuse(c_.file, child, named + " without from or to is not supported: just-in-time mapping.");
      if (child.name.find("gradient") != std::string::npos)
        refuse(c_.file, child, named + " is not supported: mapping with gradients.");
      if (child.name.find("multiscale") != std::string::npos)
        refuse(c_.file, child, named + " is not supported: mapping between dimensions.");
      if (begins(child.attribute("constraint"), "scaled"))
        refuse(c_.file, child,
               named + " with constraint \"" + child.attribute("constraint") + "\" is not supported.");
    }
  }

  /// Returns true if a projection maps values consistently from this mesh or conservatively to it.
  bool projected(const std::string& mesh) const {
    for (const Element* p : root_.all("participant"))
      for (const Element* m : p->all("mapping:nearest-projection"))
        if (m->attribute(m->attribute("constraint") == "conservative" ? "to" : "from") == mesh) return true;
    return false;
  }

  void meshes(const Element& me) {
    int dimensions = 0;
    for (const Element& child : me.children) {
      const bool provided = child.name == "provide-mesh";
      if (!provided && child.name != "receive-mesh") continue;
      const std::string name = child.attribute("name");
      const auto all = root_.all("mesh");
      const auto found = std::find_if(all.begin(), all.end(),
                                      [&](const Element* m) { return m->attribute("name") == name; });
      if (found == all.end()) refuse(c_.file, child, "there is no <mesh name=\"" + name + "\">.");
      const std::string size = (*found)->attribute("dimensions");
      if (size != "2" && size != "3")
        refuse(c_.file, **found, "dimensions of a mesh are \"2\" or \"3\", not \"" + size + "\".");
      c_.meshes.push_back({name, size == "2" ? 2 : 3, provided, provided && projected(name)});
      if (!provided) continue;
      if (dimensions == 0) dimensions = c_.meshes.back().dimensions;
      if (c_.meshes.back().dimensions != dimensions)
        refuse(c_.file, child, "meshes of two and of three dimensions in one participant are not supported.");
    }
    if (dimensions == 0) refuse(c_.file, me, "a participant that provides no mesh is not supported.");
  }

  void data(const Element& me) {
    for (const Element& child : me.children) {
      const bool written = child.name == "write-data";
      if (!written && child.name != "read-data") continue;
      const std::string name = child.attribute("name"), mesh = child.attribute("mesh");
      if (!is_vector_.count(name))
        refuse(c_.file, child, "there is no <data:scalar> or <data:vector> with name \"" + name + "\".");
      const Configuration::Mesh* used = c_.mesh(mesh);
      if (!used)
        refuse(c_.file, child,
               "\"" + c_.participant + "\" neither provides nor receives the mesh \"" + mesh + "\".");
      if (!used->provided)
        refuse(c_.file, child,
               "data on a received mesh (\"" + mesh +
                   "\") are not supported: direct access and just-in-time mapping.");
      c_.data.push_back({mesh, name, is_vector_[name], written});
    }
  }

  /// Meshes of `who` on which it writes (reads) a datum exchanged on `mesh`; true if mapped conservatively.
  std::map<std::string, bool> ends(const Element& who, const std::string& datum, const std::string& mesh,
                                   bool writes) const {
    std::map<std::string, bool> reached, found;
    for (const Element* p : who.all("provide-mesh"))
      if (p->attribute("name") == mesh) reached[mesh] = false;
    for (const Element& m : who.children)
      if (begins(m.name, "mapping:") && m.attribute("direction") == (writes ? "write" : "read") &&
          m.attribute(writes ? "to" : "from") == mesh)
        reached[m.attribute(writes ? "from" : "to")] = m.attribute("constraint") == "conservative";
    for (const Element* d : who.all(writes ? "write-data" : "read-data"))
      if (const auto end = reached.find(d->attribute("mesh"));
          d->attribute("name") == datum && end != reached.end())
        found.insert(*end);
    return found;
  }

  void scheme(const Element& s) {
    const bool serial = begins(s.name, "coupling-scheme:serial");
    const bool implicit = s.name.find("explicit") == std::string::npos;
    const auto pair = s.all("participants");
    const std::string first = pair.empty() ? "" : pair[0]->attribute("first");
    bool mine = !pair.empty() && (first == c_.participant || pair[0]->attribute("second") == c_.participant);
    for (const Element* p : s.all("participant")) mine = mine || p->attribute("name") == c_.participant;
    if (mine) {
      c_.implicit = c_.implicit || implicit;
      c_.introduction +=
          std::string("\x1e") + (implicit ? "implicit" : "explicit") +
          (serial && !pair.empty() ? "\x1fserial\x1f" + first + "\x1f" + pair[0]->attribute("second")
                                   : "\x1fparallel");
    }
    for (const Element* w : s.all("time-window-size"))
      if (mine && w->attribute("method") == "first-participant")
        refuse(c_.file, *w, "<time-window-size method=\"first-participant\"> is not supported.");
    for (const Element* e : s.all("exchange")) {
      const std::string giver = e->attribute("from"), taker = e->attribute("to"),
                        datum = e->attribute("data");
      const auto starts = ends(participant(giver), datum, e->attribute("mesh"), true);
      const auto stops = ends(participant(taker), datum, e->attribute("mesh"), false);
      // Data that the receiver does not read serve only the convergence measures, which the coupler computes.
      const auto reads = participant(taker).all("read-data");
      const bool unread = std::none_of(reads.begin(), reads.end(),
                                       [&](const Element* d) { return d->attribute("name") == datum; });
      if ((starts.empty() && giver == c_.participant) ||
          (stops.empty() && !unread && taker == c_.participant))
        refuse(c_.file, *e,
               "no mapping of \"" + c_.participant + "\" leads \"" + datum + "\" on mesh \"" +
                   e->attribute("mesh") + "\" to where it is read or written.");
      const bool sub_steps = e->attribute("substeps").empty() || is_true(e->attribute("substeps"));
      if (const int degree = degree_[datum]; degree > 1 && !sub_steps)
        refuse(c_.file, *e,
               "waveform-degree " + std::to_string(degree) + " of \"" + datum +
                   "\" needs its values at the sub-steps: substeps=\"true\".");
      for (const auto& [from, from_conservative] : starts)
        for (const auto& [to, to_conservative] : stops)
          connections_.push_back({datum, giver, from, taker, to, from_conservative || to_conservative,
                                  is_true(e->attribute("initialize")), implicit, !serial || taker == first,
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
                         ": this case does not name the configuration of preCICE that it was made of (\"" +
                         mark + "...\", as couplet import writes it).");
}

Configuration read_configuration(const std::string& file, const std::string& participant) {
  const std::string ending = std::filesystem::path(file).extension().string();
  const bool is_case = ending == ".yaml" || ending == ".yml";
  return Reader(is_case ? configuration_of_case(file) : file, participant).read();
}

}  // namespace couplet::dropin
