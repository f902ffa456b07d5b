// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/shared_seat.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/base/text.hpp"

namespace couplet::app {
namespace {

class Seat {
 public:
  Seat(config::Document& document, std::string contact)
      : document_(document), contact_(std::move(contact)), keys_(config::keys_of(document, contact_)) {}

  std::vector<std::string> problems() {
    const auto fluid = config::text_of(document_, "coupling.fluid.participant");
    const std::string gaps = fluid ? "participants." + *fluid + ".gaps" : "";
    const std::vector<std::string> names =
        fluid ? config::keys_of(document_, gaps) : std::vector<std::string>();
    if (has("gap"))
      take(*config::text_of(document_, contact_ + ".gap"), gaps, names);
    else
      look_beside(gaps, names);
    return problems_;
  }

 private:
  bool has(const char* key) const { return std::ranges::find(keys_, key) != keys_.end(); }
  void say(const std::string& key, const std::string& what) {
    problems_.push_back(fmt::format("{}: {}.", config::where(document_, contact_ + "." + key), what));
  }

  void take(const std::string& name, const std::string& gaps, const std::vector<std::string>& names) {
    if (gaps.empty()) return say("gap", "it names a gap of the fluid, and no fluid is coupled");
    if (std::ranges::find(names, name) == names.end())
      return say("gap", "the fluid has no gap '" + name + "'. " + base::did_you_mean(name, names, "gaps"));
    for (const char* key : {"height", "opening", "direction"})
      if (has(key))
        say(key, fmt::format("it is that of the gap '{}', where it stands already; remove it here", name));
    if (!problems_.empty()) return;
    const std::string gap = gaps + "." + name;
    const auto height = config::text_of(document_, gap + ".height"),
               opening = config::text_of(document_, gap + ".opening");
    if (!height) return say("gap", fmt::format("the gap '{}' needs the 'height' of its seat", name));
    set("height", '"' + *height + '"');
    if (opening) set("opening", *opening);
    const std::vector<std::string> direction = config::texts_of(document_, gap + ".direction");
    if (!direction.empty()) set("direction", fmt::format("[{}]", fmt::join(direction, ", ")));
  }

  /// A gap that states its seat, and a contact beside it that states another.
  void look_beside(const std::string& gaps, const std::vector<std::string>& names) {
    for (const std::string& name : names)
      if (config::text_of(document_, gaps + "." + name + ".height"))
        return say("height",
                   fmt::format("the gap '{0}' of the fluid states a seat as well: use 'gap: {0}' in "
                               "place of 'height' here, or remove its 'height'",
                               name));
  }

  void set(const char* key, const std::string& value) {
    document_.set(fmt::format("{}.{}={}", contact_, key, value));
  }

  config::Document& document_;
  const std::string contact_;
  const std::vector<std::string> keys_;
  std::vector<std::string> problems_;
};

}  // namespace

std::vector<std::string> share_seats(config::Document& document) {
  const auto structure = config::text_of(document, "coupling.structure.participant");
  if (!structure) return {};
  const std::string contact = "participants." + *structure + ".contact";
  if (config::keys_of(document, contact).empty()) return {};
  return Seat(document, contact).problems();
}

}  // namespace couplet::app
