// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "common/config/section.hpp"
#include "thermocline/interfaces.hpp"

namespace couplet::thermocline {

struct AmbientParameters {
  enum class Type { constant } type = Type::constant;
  Ambient constant;
};
void declare(config::Section& section, AmbientParameters& parameters);
/// `folder`: of the YAML, where relative paths start.
std::unique_ptr<AmbientSource> make_ambient(const AmbientParameters& parameters,
                                            const std::filesystem::path& folder);

class ConstantAmbient final : public AmbientSource {
 public:
  explicit ConstantAmbient(const Ambient& ambient) : ambient_(ambient) {}
  Ambient at(double) const override { return ambient_; }
  double mean_temperature() const override { return ambient_.temperature; }

 private:
  Ambient ambient_;
};

}  // namespace couplet::thermocline
