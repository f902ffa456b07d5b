// SPDX-License-Identifier: Apache-2.0
// Judges what small strain neglects by the largest gradient, an expansion, and the distance from buckling.
#include <algorithm>
#include <memory>

#include "common/io/checkpoint.hpp"
#include "solid_solver/diagnostics/buckling.hpp"
#include "solid_solver/diagnostics/large_strain.hpp"
#include "solid_solver/diagnostics/neglected.hpp"

namespace couplet::solid {
namespace {

class LinearTheory final : public diagnostics::Diagnostic {
 public:
  LinearTheory(const SolidView& view, std::shared_ptr<const LargeStrainChange> large_strain,
               std::shared_ptr<const LinearBuckling> buckling)
      : view_(view), large_strain_(std::move(large_strain)), buckling_(std::move(buckling)) {}

  void look(diagnostics::Report& report) override {
    Deformation now = view_.fields.deformation(view_.fields.point_displacement());
    largest_gradient_ = now.gradient = std::max(largest_gradient_, now.gradient);
    add(report, neglected_geometry(view_.body.parameters(), now, large_strain_->estimate(),
                                   large_strain_->is_bounded(), buckling_->factor()));
    add(report, unknown_yielding(view_.body.parameters(), now.strain));
  }

  void visit(io::Archive& archive) override { archive.common("linear", largest_gradient_); }

 private:
  SolidView view_;
  std::shared_ptr<const LargeStrainChange> large_strain_;
  std::shared_ptr<const LinearBuckling> buckling_;
  double largest_gradient_ = 0;
};

}  // namespace

diagnostics::Made linear_theory(const SolidView& view, std::shared_ptr<const LargeStrainChange> large_strain,
                                std::shared_ptr<const LinearBuckling> buckling) {
  return std::make_shared<LinearTheory>(view, std::move(large_strain), std::move(buckling));
}

}  // namespace couplet::solid
