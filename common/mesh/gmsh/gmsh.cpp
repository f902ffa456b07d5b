// SPDX-License-Identifier: Apache-2.0
#include "common/mesh/gmsh/gmsh.hpp"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "common/base/error.hpp"
#include "common/base/own_file.hpp"
#include "common/base/text.hpp"
#include "common/csv/csv_reader.hpp"
#include "common/log/log.hpp"
#include "common/mesh/gmsh/sandbox.hpp"
#include "common/mesh/readers/read_msh.hpp"

namespace couplet::mesh {

namespace {

namespace fs = std::filesystem;

/// Content of a file. Empty if it cannot be read.
std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Beginning of gmsh's output, whose length a script can make arbitrary.
std::string read_log(const fs::path& file) {
  std::string text(1 << 20, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(in.gcount()));
  return text;
}

/// Up to three different lines of gmsh's output that mention errors.
std::string complaints(const std::string& output) {
  std::istringstream in(output);
  std::string line, found, last;
  for (int n = 0; n < 3 && std::getline(in, line);) {
    if (!line.starts_with("Error") || line == last || line.find("----") != std::string::npos) continue;
    last = line;
    found += "\n  " + line;
    ++n;
  }
  return found;
}

/// Returns true if the errors may result from restrictions of the sandbox.
bool is_of_sandbox(const std::string& errors) {
  for (const char* words : {"open file", "system call", "socket", "directory"})
    if (errors.find(words) != std::string::npos) return true;
  return false;
}

/// Creates a .geo that includes the source. Given the source, gmsh would also read options in <source>.opt.
fs::path including(const fs::path& source, const fs::path& folder) {
  if (source.extension() != ".geo") return source;
  const fs::path own = folder / "main.geo";
  std::ofstream(own) << fmt::format("Include \"{}\";\n", source.string());
  return own;
}

std::string reason(const ProgramEnd& end) {
  if (end.signal == SIGXCPU) return "the limit of 4 hours of processor time was exceeded";
  if (end.signal == SIGXFSZ) return "a file exceeded 64 GB";
  constexpr int of_signals = 128;  // exit codes of a sandbox or shell whose program was killed by a signal
  if (const int signal = end.signal != 0 ? end.signal : end.code - of_signals; signal > 0)
    return fmt::format(
        "gmsh itself crashed or was killed: signal {}, {}; often another cell size, 'Mesh.Algorithm' or 'Mesh.Algorithm3D' in the "
        "geometry avoids a crash, and 'gmsh -3 FILE' shows where it happens",
        signal, strsignal(signal));
  return fmt::format("exit code {}", end.code);
}

/// File name beside the result, unique to this process. Several programs of a job may mesh the same file at
/// once; each writes its own, and the last rename counts.
fs::path own_name(const fs::path& result) {
  std::string host(256, '\0');
  gethostname(host.data(), host.size() - 1);
  return result.parent_path() /
         fmt::format("{}.{}.{}.msh", result.stem().stem().string(), host.c_str(), getpid());
}

Error not_writable(const fs::path& result, const fs::path& source) {
  return Error(
      "The mesh of '{}' is kept in the folder '{}', which cannot be written. Set XDG_CACHE_HOME to a folder that "
      "all computers of the run can write.",
      source.string(), result.parent_path().string());
}

constexpr std::uintmax_t most_bytes = std::uintmax_t(4) << 30;  // of all cached meshes

/// Removes the meshes that were not used for longest, but not `newest`, until the others fit the limit. Other
/// programs may do the same.
void remove_oldest(const fs::path& newest) {
  struct Kept {
    fs::file_time_type used;
    std::uintmax_t bytes;
    fs::path file;
  };
  std::vector<Kept> all;
  std::uintmax_t total = 0;
  std::error_code gone;
  for (const fs::directory_entry& entry : fs::directory_iterator(newest.parent_path(), gone)) {
    if (entry.path().extension() != ".msh") continue;
    const Kept kept{entry.last_write_time(gone), entry.file_size(gone), entry.path()};
    if (gone) continue;
    total += kept.bytes;
    if (kept.file != newest) all.push_back(kept);
  }
  std::ranges::sort(all, {}, &Kept::used);
  for (auto oldest = all.begin(); total > most_bytes && oldest != all.end(); ++oldest) {
    fs::remove(oldest->file, gone);
    total -= oldest->bytes;
  }
}

void put(const fs::path& mesh, const fs::path& result, const fs::path& source) {
  const fs::path own = own_name(result);
  std::error_code error;
  fs::remove(own, error);           // from a killed run, or a foreign link:
  fs::copy_file(mesh, own, error);  // copies only to a new file
  if (error) {
    fs::remove(own, error);
    throw not_writable(result, source);
  }
  base::flush_to_disk(own);
  fs::rename(own, result);
  remove_oldest(result);
}

constexpr std::string_view head = "$Comments\ncouplet ";

std::string seal_of(std::string_view text, const std::string& name) {
  const std::size_t digest = base::stable_hash(fmt::format("{}\n{:016x}", name, base::stable_hash(text)));
  return fmt::format("{}{:016x}\n$EndComments\n", head, digest);
}

/// Appends a digest of the file and its `name` to a .msh 4.1, as a section that readers ignore.
void seal_cache(const std::filesystem::path& file, const std::string& name) {
  const std::string seal = seal_of(text_of(file), name);
  std::ofstream out(file, std::ios::binary | std::ios::app);
  out << seal;
  out.close();
  if (!out) throw Error("Cannot write the mesh '{}'. Check the disk space.", file.string());
}

}  // namespace

fs::path cache_of(const fs::path& source, const std::string& key) {
  const auto folder_in = [](const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr && *value == '/' ? fs::path(value) : fs::path();
  };
  fs::path folder = folder_in("XDG_CACHE_HOME");
  if (folder.empty()) folder = folder_in("HOME") / ".cache";
  folder /= "couplet/meshes";
  std::error_code ignored;  // reported when a mesh is written
  fs::create_directories(folder, ignored);
  const std::string all = fs::weakly_canonical(fs::absolute(source)).string() + "\n" + key;
  return folder / fmt::format("{}.{:016x}.cache.msh", source.stem().string(), base::stable_hash(all));
}

bool is_sound_cache(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return false;
  const std::string text = text_of(file);
  const std::size_t at = text.rfind(head);
  if (at != std::string::npos &&
      std::string_view(text).substr(at) ==
          seal_of(std::string_view(text).substr(0, at), file.filename().string())) {
    std::error_code ignored;  // of another user's
    fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
    return true;
  }
  log::warn("The cached mesh '{}' is damaged or was not written by Couplet, so it is regenerated.",
            file.string());
  return false;
}

void run_gmsh(const std::vector<std::string>& options, const fs::path& source, bool trusted,
              const fs::path& result, const std::string& verb) {
  if (access(result.parent_path().c_str(), W_OK) != 0) throw not_writable(result, source);
  const OwnFolder folder;
  const fs::path mesh = folder.path() / "mesh.msh", log = folder.path() / "gmsh.log",
                 place = fs::canonical(fs::absolute(source).parent_path()),
                 read = place / source.filename();  // a name that starts with '-' would be an option
  std::vector<std::string> command{"gmsh", "-nopopup", "-format", "msh41", "-v", "2"};
  command.insert(command.end(), options.begin(), options.end());
  command.insert(command.end(), {"-o", mesh.string()});
  if (const std::string own = read.string() + ".opt"; trusted && fs::exists(own))
    command.insert(command.end(), {"-option", own});
  command.push_back(including(read, folder.path()).string());
  const ProgramEnd end = trusted ? run_trusted(command, log)
                                 : run_in_sandbox(command, folder.path(), log, {place, fs::canonical(read)});
  const std::string errors = complaints(read_log(log));
  if (end.code != 0 || !errors.empty() || !fs::is_regular_file(fs::symlink_status(mesh)))
    throw Error(
        "gmsh could not {} '{}' ({}).{}{}", verb, source.string(), reason(end), errors,
        trusted || !is_of_sandbox(errors)
            ? ""
            : "\nHere a geometry may neither run commands nor use files outside its folder. If it must and you "
              "trust the case, start with --allow-commands.");
  if (text_of(mesh).find("$Nodes") == std::string::npos)
    throw Error("gmsh could not {} '{}': it found no nodes in it.", verb, source.string());
  seal_cache(mesh, result.filename().string());
  put(mesh, result, source);
}

namespace {

/// Returns true if gmsh was built with CGNS. One that was not would take the file for a script.
bool reads_cgns() {
  const OwnFolder folder;
  run_in_sandbox({"gmsh", "-info"}, folder.path(), folder.path() / "info.log");
  std::istringstream words(read_log(folder.path() / "info.log"));
  for (std::string word; words >> word;)
    if (word == "Cgns" || word.starts_with("Cgns[")) return true;
  return false;
}

}  // namespace

fs::path convert_mesh(const fs::path& file) {
  if (file.extension() == ".msh" && !is_converted(file)) return file;
  if (file.extension() == ".cgns" && !reads_cgns())
    throw Error(
        "Cannot read the mesh '{}': the gmsh on the PATH was built without CGNS. Export it in another format: "
        "{}.",
        file.string(), formats_with_names);
  if (!std::ifstream(file))
    throw Error("Cannot open the file '{}'. Check the path and the permissions.", file.string());
  const fs::path result = cache_of(file, text_of(file));
  if (is_sound_cache(result)) return result;
  log::info("reading {} with gmsh", file.string());
  run_gmsh({"-0", "-save_all"}, file, false, result, "read");
  return result;
}

namespace {

constexpr int no_module = 3;  // exit code of the script
constexpr std::size_t most_complaints = 3;

// Reads a mesh of another program and writes it as a .msh.
constexpr const char* script =
#include "deck.inc"
#include "deck_mesh.inc"
#include "to_msh.inc"
    ;

bool is_note(const std::string& line) { return line.starts_with("info: ") || line.starts_with("warning: "); }

/// Last lines printed by Python, which contain its error.
std::string complaint(std::vector<std::string> lines) {
  std::string text;
  std::erase_if(lines, is_note);
  if (lines.size() > most_complaints) lines.erase(lines.begin(), lines.end() - most_complaints);
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n  ") + line;
  return text;
}

}  // namespace

bool is_foreign(std::string extension) {
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  constexpr std::string_view all[] = {".inp", ".unv", ".med", ".exo", ".e",  ".ex2",
                                      ".g",   ".gen", ".su2", ".bdf", ".nas"};
  return std::ranges::find(all, extension) != std::end(all);
}

RawMesh read_foreign(const fs::path& file) {
  const OwnFolder folder;
  const fs::path msh = folder.path() / "mesh.msh", log = folder.path() / "python.log";
  log::info("reading {} with Python", file.string());
  const auto run = [&](const std::string& python) {
    // A deck may include files of its folder.
    const fs::path whole = fs::canonical(file);
    return run_in_sandbox({python, "-c", script, fs::absolute(file).string(), msh.string(), file.string()},
                          folder.path(), log,
                          {file.extension() == ".inp" ? whole.parent_path() : whole, whole});
  };
  ProgramEnd end = run("python3");
  // A python3 of the user's own may lack what that of the system has.
  const char* system_python = "/usr/bin/python3";
  if (end.code == no_module && fs::exists(system_python)) end = run(system_python);
  const std::vector<std::string> lines = csv::read_lines(log, "output of python3", {.text_only = false});
  if (end.code == no_module)
    throw Error(
        "The mesh '{}' is read with the Python module h5py, which python3 on the PATH lacks. Install it "
        "(Debian: apt install python3-h5py), or export the mesh in another format: {}.",
        file.string(), formats_with_names);
  if (end.code != 0 || !fs::is_regular_file(fs::symlink_status(msh)))
    throw Error("{}", end.signal != 0
                          ? fmt::format("Cannot read the mesh '{}': python3 was killed by signal {}.",
                                        file.string(), end.signal)
                          : complaint(lines));
  for (const std::string& line : lines)
    if (is_note(line))
      line.starts_with("warning") ? log::warn("{}", line.substr(line.find(' ') + 1))
                                  : log::info("{}", line.substr(line.find(' ') + 1));
  return read_msh(msh);
}

}  // namespace couplet::mesh
