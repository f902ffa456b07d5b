// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common/coupling/messages.hpp"

namespace couplet::coupler {

/// Data of a program that calls them otherwise than the coupler, as it announced them: of a role, in one direction.
struct ForeignNames {
  std::vector<coupling::Interface::Datum>& data;
  std::map<std::string, int>& surface_of;  ///< of those of them that are of one surface alone
  const char* role;                        ///< "fluid", "structure"
  const std::string& who;                  ///< the participant
  const char* does;                        ///< "takes", "gives"

  std::vector<coupling::Interface::Datum>::iterator find(const std::string& name) const;
  /// From now on `datum` is called `name`.
  void rename(coupling::Interface::Datum& datum, const std::string& name) const;
  /// `name` is of the same surface as `datum`.
  void put_beside(const std::string& datum, const std::string& name) const;
  /// Throws Error: what `key` of the role names is not among them.
  [[noreturn]] void refuse(const char* key, const std::string& wanted) const;
};

}  // namespace couplet::coupler
