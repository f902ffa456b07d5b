// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/section.hpp"

namespace couplet::config {

/// What is done with declarations; Section forwards everything it is told.
class Visitor {
 public:
  using Facts = Key::Facts;
  using Declare = Section::Declare;
  using Cases = std::vector<std::pair<std::string, Declare>>;
  virtual ~Visitor() = default;
  virtual void key(const Facts& facts, const Slot& slot) = 0;
  virtual void section(std::string_view name, std::string_view doc, const Declare& declare) = 0;
  /// present: the member holds a value now.
  virtual void optional(std::string_view name, bool present, std::string_view doc,
                        const Declare& declare) = 0;
  virtual void map(std::string_view name, const std::vector<std::string>& present, std::string_view what,
                   std::string_view doc,
                   const std::function<void(const std::string&, Section&)>& declare) = 0;
  virtual void list(std::string_view name, std::size_t present, std::string_view doc,
                    const std::function<void(std::size_t, Section&)>& declare) = 0;
  /// facts: name, doc, required.
  virtual void variant(const Facts& facts, const Cases& cases, const std::string& current,
                       const std::function<void(const std::string&)>& set) = 0;
  virtual void check(const std::function<std::string()>& rule, std::string_view key) = 0;
  virtual void doubt(const std::function<std::string()>&, std::string_view) {}
};

/// std::visit with one lambda a type.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace couplet::config
