// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/elasticity/finite/finite_law.hpp"

namespace couplet::laws {

/// `lame`: at small strain. `coefficients`: further constants of the law; missing ones are zero.
using MakeLaw = std::unique_ptr<elastic::FiniteLaw> (*)(const elastic::LameConstants& lame,
                                                        std::span<const double> coefficients);

std::unique_ptr<elastic::FiniteLaw> saint_venant_kirchhoff(const elastic::LameConstants&,
                                                           std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> neo_hookean(const elastic::LameConstants&, std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> nearly_incompressible_neo_hookean(const elastic::LameConstants&,
                                                                      std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> mooney_rivlin(const elastic::LameConstants&, std::span<const double>);
std::unique_ptr<elastic::FiniteLaw> yeoh(const elastic::LameConstants&, std::span<const double>);

/// Law with its name in the YAML file.
struct Entry {
  const char* name;
  MakeLaw make;
  std::size_t n_coefficients;  ///< largest number
  const char* coefficients;    ///< their names
};

/// All laws, in the order of the documentation.
std::span<const Entry> all();
/// nullptr if there is no law of this name.
const Entry* find(const std::string& name);
/// Like find(); without a name the first law, Saint Venant-Kirchhoff.
const Entry* of(const std::string& name);
std::vector<std::string> names();

}  // namespace couplet::laws
