// SPDX-License-Identifier: Apache-2.0
// What the tests of participants with names of their own share.
#pragma once

#include "common/io/checkpoint.hpp"
#include "common/log/log.hpp"
#include "coupler/coupler.hpp"
#include "tests/coupling/support/local_channel.hpp"
#include "tests/support/test.hpp"

namespace couplet {

/// Has a surface and answers; keeps and writes nothing.
class Quiet : public coupling::Participant {
 public:
  void begin_step(const coupling::Step& step) override { step_ = step; }
  coupling::StepReport accept_step() override { return {.dt = step_.dt}; }
  void save(io::CheckpointWriter&) const override {}
  void load(io::CheckpointReader&) override {}
  void write_output(double, int) override {}
  void write_monitors(double) override {}

 protected:
  coupling::Step step_;
};

/// Vertices at equal distances on 0 <= x <= 1; `faces` between them, of areas (0, height / n).
inline void lay_out(coupling::Interface& line, int n_vertices, bool faces = false, double height = 1) {
  const int n = n_vertices - 1;
  for (int i = 0; i <= n; ++i) line.vertices.emplace_back(double(i) / n, 0, 0);
  if (!faces) return;
  line.face_offset = {0};
  for (int i = 0; i < n; ++i) {
    line.face_centres.emplace_back((i + 0.5) / n, 0, 0);
    line.face_areas.emplace_back(0, height / n, 0);
    line.face_vertices.insert(line.face_vertices.end(), {Index(i), Index(i + 1)});
    line.face_offset.push_back(2 * (i + 1));
  }
}

/// A case of a fluid and a solid in one process, in a folder of its own.
struct ForeignCase {
  coupler::CouplingParameters coupling;
  app::SimulationParameters simulation;
  std::filesystem::path folder = std::filesystem::temp_directory_path() /
                                 ("couplet-foreign-" + std::to_string(::getpid())),
                        restart;

  ForeignCase() {
    spdlog::set_level(spdlog::level::off);
    coupling.scheme = coupling::Scheme::implicit;
    coupling.mapping.type = coupler::MappingParameters::Type::projection;
  }
  ~ForeignCase() { std::filesystem::remove_all(folder); }

  std::unique_ptr<coupler::Coupler> coupler(coupling::Participant& fluid,
                                            coupling::Participant& solid) const {
    std::filesystem::create_directories(folder);
    return std::make_unique<tests::LocalCoupler>(
        coupling, simulation, fluid, solid, nullptr,
        coupler::CouplerFolders{folder, folder / "checkpoints", restart});
  }
};

}  // namespace couplet
