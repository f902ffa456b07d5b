// SPDX-License-Identifier: Apache-2.0
// Damaged checkpoint sets: refused, or read as one of the sets that were written. See README.md.
#include "common/app/loop/step_loop.hpp"
#include "common/io/checkpoint.hpp"
#include "common/io/checkpoint_set.hpp"
#include "tests/fuzz/mutate.hpp"

namespace couplet::fuzz::checkpoint_fuzz {

namespace fs = std::filesystem;

const std::vector<std::string> participants{"fluid", "solid", "coupler"};

/// All that a restart reads.
struct State {
  double time = 0;
  std::vector<std::vector<double>> values;
  std::string keys;
  bool operator==(const State&) const = default;
};

/// A run of four steps that keeps three checkpoints.
void write_sets(const fs::path& folder, const std::string& keys, double offset) {
  app::SimulationParameters simulation;
  simulation.end_time = 4;
  simulation.time_step = 1;
  simulation.checkpoint_interval = 1;
  simulation.checkpoints_kept = 3;
  simulation.keys = keys;
  app::StepLoop loop(MPI_COMM_SELF, simulation, coupling::Scheme::standalone, folder);
  double time = 0;
  app::StepActions actions;
  actions.attempt = [](const coupling::Step&) { return std::nullopt; };
  actions.accept = [&](double t, int) { time = t; };
  actions.write_start = [](int) {};
  actions.report = [](const coupling::Step&, double) {};
  actions.save = [&](const fs::path& place) {
    for (std::size_t p = 0; p < participants.size(); ++p) {
      io::CheckpointWriter file(MPI_COMM_SELF, place / (participants[p] + ".h5"));
      std::vector<double> values(50);
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = offset + 100 * time + 10 * double(p) + 0.01 * double(i);
      file.write("u", values);
      file.write_common("dt", std::array<double, 1>{time + double(p)});
      file.close();
    }
  };
  ASSERT_EQ(loop.run(actions), "");
}

/// As the programs do: the folder is chosen, then each reads its own file.
State read_state(const fs::path& folder) {
  const fs::path set = app::find_checkpoint(folder);
  State state;
  state.time = app::read_run_state(set).time;
  if (const std::string problem = io::problem_in_set(set / "keys.txt"); !problem.empty())
    throw Error("{}", problem);
  state.keys = read_file(set / "keys.txt");
  for (const std::string& name : participants) {
    io::CheckpointReader file(MPI_COMM_SELF, set / (name + ".h5"));
    state.values.push_back(file.read("u"));
    io::Archive(file).common("dt", state.values.back().emplace_back());
  }
  return state;
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// One kind of damage to the sets of two runs, `a` and `b`; the restart is from `a`.
void damage(const fs::path& a, const fs::path& b, Dice& dice) {
  const std::vector<fs::path> mine = files_in(a), others = files_in(b);
  // The last set is the one that is taken: most of the damage goes there.
  std::vector<fs::path> last;
  for (const fs::path& file : mine)
    if (file.parent_path().filename() == "step-00000004") last.push_back(file);
  const fs::path file = dice.one_in(5) ? dice.of(mine) : dice.of(last);
  std::string text = read_file(file);
  switch (dice.below(11)) {
    case 0:  // one bit
      text[dice.below(text.size())] ^= char(1 << dice.below(8));
      write_file(file, text);
      break;
    case 1:  // cut off
      text.resize(dice.below(text.size()));
      write_file(file, text);
      break;
    case 2: {  // a block of zeros
      const std::size_t at = dice.below(text.size());
      std::fill_n(text.begin() + std::ptrdiff_t(at),
                  std::min<std::size_t>(text.size() - at, 1 + dice.below(512)), '\0');
      write_file(file, text);
      break;
    }
    case 3: {  // values moved by one place
      const std::size_t at = dice.below(text.size() - 1);
      text.insert(at, text.substr(at, 8));
      if (dice.one_in(2)) text.resize(text.size() - 8);
      write_file(file, text);
      break;
    }
    case 4: {  // the same file of another step or of another run
      std::vector<fs::path> same;
      for (const auto* list : {&mine, &others})
        for (const fs::path& f : *list)
          if (f.filename() == file.filename() && f != file) same.push_back(f);
      fs::copy_file(dice.of(same), file, fs::copy_options::overwrite_existing);
      break;
    }
    case 5:  // another file of the set
      fs::copy_file(dice.of(last), file.string() + "~");
      fs::rename(file.string() + "~", file);
      break;
    case 6:
      fs::remove(file);
      break;
    case 7:  // steps change their folders' names
      fs::rename(a / "step-00000004", a / "x");
      fs::rename(a / "step-00000003", a / "step-00000004");
      fs::rename(a / "x", a / (dice.one_in(2) ? "step-00000003" : "step-00000099"));
      break;
    case 8: {  // the list of another set
      const fs::path from = dice.one_in(2) ? a / "step-00000003" : b / "step-00000004";
      fs::copy_file(from / "set.txt", a / "step-00000004/set.txt", fs::copy_options::overwrite_existing);
      break;
    }
    case 9: {  // lines of the list
      const fs::path list = a / "step-00000004/set.txt";
      write_file(list, mutate_lines(read_file(list), {"1"}, dice));
      break;
    }
    default:  // one byte too many or other ones somewhere
      write_file(file, mutate_bytes(text, dice));
  }
}

TEST(Checkpoints, damaged_sets_never_continue_with_another_result) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("couplet-fuzz-checkpoint-{}", ::getpid());
  fs::remove_all(folder);
  write_sets(folder / "a", "x = 1\n", 0);
  write_sets(folder / "b", "x = 2\n", 5000);
  std::vector<State> right;
  for (const char* step : {"step-00000002", "step-00000003", "step-00000004"})
    right.push_back(read_state(folder / "a" / step));
  ASSERT_EQ(read_state(folder / "a"), right.back());
  Dice dice(seed());
  std::size_t refused = 0, same = 0, earlier = 0;
  for (std::size_t i = 0; i < count(); ++i) {
    const fs::path last = folder / "last";
    fs::remove_all(last);
    fs::create_directories(last);
    fs::copy(folder / "a", last / "a", fs::copy_options::recursive);
    fs::copy(folder / "b", last / "b", fs::copy_options::recursive);
    damage(last / "a", last / "b", dice);
    try {
      const State state = read_state(last / "a");
      const auto found = std::find(right.begin(), right.end(), state);
      ASSERT_NE(found, right.end()) << "case " << i << ": another result was accepted, see " << last;
      ++(found + 1 == right.end() ? same : earlier);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, count() / 3);
  RecordProperty("tried", int(count()));
  RecordProperty("refused", int(refused));
  RecordProperty("earlier_set", int(earlier));
  RecordProperty("unharmed", int(same));
  fs::remove_all(folder);
}

}  // namespace couplet::fuzz::checkpoint_fuzz
