// SPDX-License-Identifier: Apache-2.0
// Effects that are off cost nothing: neither memory nor time of a step. Allocations are counted by replacing
// operator new in this executable; a step that makes none and calls nobody has the same work whether an
// effect exists or not.
#include <new>

#include "plate_modal/structure.hpp"
#include "tests/verification/plate/plates.hpp"

namespace {
long allocations = 0;
long long allocated = 0;
}  // namespace

void* operator new(std::size_t size) {
  ++allocations;
  allocated += static_cast<long long>(size);
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

namespace couplet::plate::effects_test {
namespace {

using namespace test;

struct Cost {
  long allocations = 0;      // of ten steps
  long long bytes = 0;       // of ten steps
  long long bytes_made = 0;  // of making the oscillators and the seat
};

modes::ModalModel body() {
  modes::ModalModel model;
  model.vertices = {{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};
  model.faces.push_row(std::array<Index, 4>{0, 1, 2, 3});
  model.frequency.assign(10, 5);
  for (int v = 0; v < 4; ++v)
    for (int c = 0; c < 3; ++c) model.vertex_shape.insert(model.vertex_shape.end(), 10, c == 2 ? 1 : 0);
  model.participation.assign(30, 1);
  modes::average_faces(model);
  return model;
}

Cost cost(bool seat, double damping, double gravity,
          time::TimeScheme scheme = time::TimeScheme::trapezoidal) {
  const Surface surface(body());
  Cost result;
  const long long before_making = allocated;
  ContactParameters p;
  p.height.text = fmt::format("{}", -1);
  p.stiffness = 1e3;
  std::unique_ptr<Contact> contact;
  if (seat) contact = std::make_unique<Contact>(surface, p, Vec3::UnitZ(), 1);
  Oscillators modes(surface.omega(), std::vector<double>(10, damping), std::vector<double>(10, gravity),
                    {scheme}, contact.get());
  result.bytes_made = allocated - before_making;
  ModalState now = modes.start(std::vector<double>(10, 0.1), std::vector<double>(10, -5)), next = now;
  const Oscillators::LoadAt load = [](double, std::span<double> f) { std::ranges::fill(f, 1); };
  const auto step = [&] {
    modes.step(now, 0.01, load, next);
    std::swap(now, next);
  };
  step(), step();
  const long before = allocations;
  const long long bytes = allocated;
  for (int i = 0; i < 10; ++i) step();
  result.allocations = allocations - before;
  result.bytes = allocated - bytes;
  return result;
}

TEST(PlateEffects, a_step_without_seat_allocates_the_list_of_its_stages_alone) {
  const Cost plain = cost(false, 0, 0);
  // One list of one stage (trapezoidal) a step, nothing of the size of the structure.
  EXPECT_LE(plain.allocations, 10);
  EXPECT_LE(plain.bytes, 10 * static_cast<long long>(sizeof(time::Stage)));
  const Cost full = cost(false, 0.3, -9.81);
  EXPECT_EQ(full.allocations, plain.allocations);
  EXPECT_EQ(full.bytes, plain.bytes);
  EXPECT_EQ(full.bytes_made, plain.bytes_made);
  RecordProperty("allocations", std::to_string(plain.allocations));
}

TEST(PlateEffects, a_seat_costs_memory_only_where_there_is_one) {
  const Cost without = cost(false, 0, 0), with = cost(true, 0, 0);
  EXPECT_GT(with.bytes_made, without.bytes_made + 100 * static_cast<long long>(sizeof(double)));
}

}  // namespace
}  // namespace couplet::plate::effects_test
