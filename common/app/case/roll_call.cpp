// SPDX-License-Identifier: Apache-2.0
#include "common/app/case/roll_call.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <map>
#include <set>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/coupling/messages.hpp"
#include "common/coupling/roles.hpp"
#include "common/coupling/wait.hpp"
#include "common/parallel/collective.hpp"

namespace couplet::app {
namespace {

// One text per process with fields separated by unit separators, which no name, path or message contains.
constexpr char field_end = '\x1f', text_end = '\x1e';
constexpr std::size_t longest_text = 256;
constexpr std::int64_t hello_mark = 0x434f55504c4554;  // "COUPLET"

std::string encode(const Attendant& a) {
  std::string text;
  for (const std::string& field : {a.program, a.participant, a.case_file, std::to_string(a.case_hash),
                                   a.restart, std::string(a.named ? "1" : "0"), std::to_string(a.application),
                                   std::to_string(a.world_rank), a.process})
    text += field + field_end;
  for (const std::string& error : a.errors) text += error + field_end;
  return text + text_end;
}

template <class T>
bool parse(const std::string& text, T& value) {
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() && end == text.data() + text.size();
}

bool is_name(const std::string& text) {
  return text.size() <= longest_text &&
         std::ranges::none_of(text, [](unsigned char c) { return c < 32 || c == 127; });
}

std::string label(const Attendant& a) { return a.participant.empty() ? a.program : a.participant; }

/// The first that reads the case: a guest that does not says 0.
const Attendant& reader_of(const std::vector<Attendant>& attendants) {
  const auto reader = std::ranges::find_if(attendants, [](const Attendant& a) { return a.case_hash != 0; });
  return reader == attendants.end() ? attendants.front() : *reader;
}

/// "couplet run case.yaml -n fluid=2 --with body='COMMAND ...'"
std::string launch_line(const std::vector<Attendant>& attendants, const std::vector<Expected>& expected) {
  std::map<std::string, int> ranks, application;
  for (const Attendant& a : attendants)
    if (application.try_emplace(a.participant, a.application).first->second == a.application)
      ++ranks[a.participant];
  std::string sizes, commands;
  for (const Expected& e : expected) {
    if (ranks[e.participant] > 1)
      sizes += fmt::format("{}{}={}", sizes.empty() ? " -n " : ",", e.participant, ranks[e.participant]);
    if (e.program != coupler_name && coupling::player_of(e.program) == nullptr)
      commands += fmt::format(" --with {}='COMMAND ...'", e.participant);
  }
  return "couplet run " + reader_of(attendants).case_file + sizes + commands;
}

/// Lists each message once, with the names of its senders unless all processes sent it.
std::string configuration_errors(const std::vector<Attendant>& attendants) {
  std::vector<std::string> order;
  std::map<std::string, std::set<std::string>> senders;
  std::set<std::string> everyone;
  for (const Attendant& a : attendants) {
    everyone.insert(label(a));
    for (const std::string& error : a.errors) {
      if (!senders.count(error)) order.push_back(error);
      senders[error].insert(label(a));
    }
  }
  std::string text;
  for (const std::string& error : order) {
    const auto& who = senders[error];
    text += who.size() == everyone.size() && who.size() > 1
                ? fmt::format("\n  {}", error)
                : fmt::format("\n  [{}] {}", base::join({who.begin(), who.end()}), error);
  }
  return text;
}

/// First difference between what two processes read.
std::string disagreement(const std::vector<Attendant>& attendants) {
  const Attendant& first = reader_of(attendants);
  for (const Attendant& a : attendants) {
    if (a.case_hash == 0) continue;
    if (a.case_hash != first.case_hash)
      return fmt::format(
          "\n  '{}' reads {} and '{}' reads {}, and the contents differ. All programs of a job need the same YAML file and the "
          "same --set options.",
          label(first), first.case_file, label(a), a.case_file);
    if (a.restart != first.restart)
      return fmt::format(
          "\n  '{}' {} and '{}' {}. Either all programs of a job restart, from the same folder, or none.",
          label(first), first.restart.empty() ? "starts afresh" : "was given --restart " + first.restart,
          label(a), a.restart.empty() ? "starts afresh" : "was given --restart " + a.restart);
  }
  return "";
}

std::string attendance(const std::vector<Attendant>& attendants, const std::vector<Expected>& expected) {
  std::string text;
  std::map<std::string, std::set<int>> parts;
  std::map<std::string, std::set<std::string>> programs;
  for (const Attendant& a : attendants) {
    parts[a.participant].insert(a.application);
    programs[a.participant].insert(a.program);
  }
  for (const Expected& e : expected)
    if (!parts.count(e.participant))
      text +=
          fmt::format("\n  participant '{}' ({}) is missing: it was not started.", e.participant, e.program);
  for (const auto& [participant, numbers] : parts) {
    const auto& run_by = programs[participant];
    if (numbers.size() > 1 || run_by.size() > 1)
      text += fmt::format(
          "\n  {} programs were started as participant '{}' ({}); each participant runs once. Give each program its own "
          "--participant.",
          std::max(numbers.size(), run_by.size()), participant, base::join({run_by.begin(), run_by.end()}));
    const bool known =
        std::any_of(expected.begin(), expected.end(),
                    [&name = participant](const Expected& e) { return e.participant == name; });
    if (!known) text += fmt::format("\n  '{}' was started, but the YAML file does not list it.", participant);
  }
  return text;
}

}  // namespace

Attendant introduced(const std::string& text, int process) {
  std::vector<std::string> fields;
  std::istringstream in(text);
  for (std::string field; std::getline(in, field, field_end);) fields.push_back(field);
  const auto malformed = [&](const std::string& why) {
    return Error(
        "The handshake of process {} of the job is malformed: {}. docs/protocol.md, step 3, describes the format.",
        process, why);
  };
  if (fields.size() < 9) throw malformed(fmt::format("it has {} fields, but 9 are expected", fields.size()));
  Attendant a;
  a.program = fields[0];
  a.participant = fields[1];
  a.case_file = fields[2];
  a.restart = fields[4];
  a.named = fields[5] == "1";
  if (!is_name(a.program) || !is_name(a.participant))
    throw malformed(
        fmt::format("the names of its program and participant contain control characters or more than {} "
                    "bytes",
                    longest_text));
  if (!parse(fields[3], a.case_hash) || !parse(fields[6], a.application) || !parse(fields[7], a.world_rank))
    throw malformed("the hash of its case, the index of its program or its rank is not a whole number");
  if (a.world_rank != process) throw malformed(fmt::format("it claims to be process {}", a.world_rank));
  a.process = fields[8];
  a.errors.assign(fields.begin() + 9, fields.end());
  return a;
}

void check_hands(std::span<const std::int64_t> all) {
  const std::size_t n = all.size() / 4;
  const auto is_ours = [&](std::size_t r) {
    return all[4 * r] == hello_mark && all[4 * r + 1] == coupling::protocol_version && all[4 * r + 2] == 0;
  };
  std::size_t speaker = 0;
  while (speaker < n && !is_ours(speaker)) ++speaker;
  const auto fail = [&](const std::string& text) { throw HandshakeFailure(text, int(speaker)); };
  for (std::size_t r = 0; r < n; ++r) {
    const std::int64_t mark = all[4 * r], version = all[4 * r + 1], kind = all[4 * r + 2];
    if (mark != hello_mark)
      fail(fmt::format(
          "Process {} of the job is not a Couplet program: its handshake begins with {}. docs/protocol.md "
          "describes how your own program can join.",
          r, mark));
    if (version != coupling::protocol_version)
      fail(fmt::format(
          "Process {} of the job ({}) uses version {} of the protocol; the Couplet programs here use "
          "version {}. Use programs and the client library from one version of Couplet.",
          r, kind == 0 ? "a program of Couplet" : "an external program", version,
          coupling::protocol_version));
    if (kind != 0 && kind != 1)
      fail(fmt::format(
          "Process {} of the job reports kind {}; expected 0 (a Couplet program) or 1 (an external program).",
          r, kind));
  }
}

MPI_Comm shake_hands(MPI_Comm world) {
  const std::array<std::int64_t, 4> mine{hello_mark, coupling::protocol_version, 0, 0};
  std::vector<std::int64_t> all(4 * std::size_t(parallel::comm_size(world)));
  MPI_Request request;
  MPI_Iallgather(mine.data(), 4, MPI_INT64_T, all.data(), 4, MPI_INT64_T, world, &request);
  coupling::wait_politely(request, "every process of the job to join (docs/protocol.md, handshake)");
  check_hands(all);
  MPI_Comm natives;
  MPI_Comm_split(world, 0, parallel::comm_rank(world), &natives);
  return natives;
}

bool all_agree_to_start(MPI_Comm world, bool problem) {
  std::int64_t worst = problem ? 1 : 0;
  MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_INT64_T, MPI_MAX, world);
  return worst == 0;
}

std::vector<Attendant> roll_call(MPI_Comm world, const Attendant& self) {
  const std::string text = encode(self);
  const std::vector<char> all = parallel::all_gather(world, std::vector<char>(text.begin(), text.end()));
  std::vector<Attendant> attendants;
  std::istringstream in(std::string(all.begin(), all.end()));
  for (std::string one; std::getline(in, one, text_end);)
    attendants.push_back(introduced(one, int(attendants.size())));
  if (attendants.size() != std::size_t(parallel::comm_size(world)))
    throw Error(
        "{} processes introduce themselves, but the job has {}: the handshake of an external program must "
        "contain exactly one end-of-text character (0x1e).",
        attendants.size(), parallel::comm_size(world));
  return attendants;
}

Attendance attendance_of(const std::vector<Attendant>& attendants, const std::vector<Expected>& expected,
                         bool coupled) {
  const Attendant& first = attendants.front();
  const auto cannot_start = [&](const std::string& why, bool with_launch_line) {
    Attendance found;
    found.problem = "The job cannot start:" + why;
    if (with_launch_line && !expected.empty())
      found.problem += fmt::format("\n  Start it with: {}", launch_line(attendants, expected));
    return found;
  };
  const std::string errors = configuration_errors(attendants);
  const bool all_placed = std::none_of(attendants.begin(), attendants.end(),
                                       [](const Attendant& a) { return a.participant.empty(); });
  // Without a `coupling` section no launch line of several programs could start.
  if (!errors.empty()) return cannot_start(errors, coupled && !all_placed && attendants.size() > 1);
  if (const std::string text = disagreement(attendants); !text.empty()) return cannot_start(text, false);

  const bool one_program = std::all_of(attendants.begin(), attendants.end(), [&](const Attendant& a) {
    return a.participant == first.participant && a.application == first.application;
  });
  const bool is_coupler = first.participant == coupler_name;
  if (one_program && !is_coupler && (first.named || !coupled)) return {"", true};
  if (!coupled)
    return cannot_start(
        fmt::format("\n"
                    "  {} has no `coupling` section, so its participants cannot run as one job: add the "
                    "section, or run each program alone.",
                    first.case_file),
        false);
  std::string text = attendance(attendants, expected);
  if (text.empty()) return {};
  if (one_program && !is_coupler)
    text += fmt::format("\n  To run '{}' alone: {} {} --participant {}", first.participant, first.program,
                        first.case_file, first.participant);
  return cannot_start(text, true);
}

std::vector<JobMember> members(const std::vector<Attendant>& attendants) {
  std::vector<JobMember> list;
  for (const Attendant& a : attendants) {
    auto it = std::find_if(list.begin(), list.end(),
                           [&](const JobMember& m) { return m.participant == a.participant; });
    if (it == list.end()) it = list.insert(list.end(), {a.participant, a.program, a.world_rank, 0});
    ++it->ranks;
  }
  return list;
}

}  // namespace couplet::app
