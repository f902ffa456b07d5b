// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/finite/finite_law.hpp"

namespace couplet::laws {

/// `lame`: at small strain; `coefficients`: what the law wants beside them, missing ones are zero.
using MakeLaw = std::unique_ptr<elastic::FiniteLaw> (*)(const elastic::LameConstants& lame,
                                                        std::span<const double> coefficients);

std::unique_ptr<elastic::FiniteLaw> saint_venant_kirchhoff(const elastic::LameConstants&,
                                                           std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> neo_hookean(const elastic::LameConstants&, std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> nearly_incompressible_neo_hookean(const elastic::LameConstants&,
                                                                      std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> mooney_rivlin(const elastic::LameConstants&, std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> yeoh(const elastic::LameConstants&, std::span<const double>);

/// A law as the YAML names it.
struct Entry {
  const char* name;
  MakeLaw make;
  std::size_t n_coefficients;  ///< it takes at most so many
  const char* coefficients;    ///< what they are
};

/// All laws, in the order in which the documentation lists them.
std::span<const Entry> all();
/// Null: there is none of this name.
const Entry* find(const std::string& name);
/// The same; no name: the first one, Saint Venant-Kirchhoff.
const Entry* of(const std::string& name);
std::vector<std::string> names();

}  // namespace couplet::laws
