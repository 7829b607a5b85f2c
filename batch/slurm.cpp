#include "batch/slurm.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include <sys/wait.h>

#include "core/error.h"
#include "output/atomic_file.h"

namespace sunder::batch {
namespace {

namespace fs = std::filesystem;

constexpr double time_margin = 2;      // nodes are slower than this machine, or share their memory's bandwidth
constexpr double least_minutes = 2;    // of a time limit
constexpr double memory_margin = 1.5;  // over what the largest job that was tried took
constexpr double least_memory_mb = 300;
constexpr double unknown_seconds = 60;       // of a job of which nothing is known
constexpr std::size_t longest_array = 4000;  // characters of an --array that every version takes

struct Said {
  int code = 0;
  std::string text;
};

/// Runs a command of the shell; its errors are part of what it says.
Said said_by(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) throw Error(ErrorKind::internal, "no process can be started");
  Said said;
  std::array<char, 4096> piece;
  while (const std::size_t count = std::fread(piece.data(), 1, piece.size(), pipe))
    said.text.append(piece.data(), count);
  const int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  return said;
}

/// For the shell: in single quotes.
std::string quoted(const std::string& text) {
  std::string result(1, '\'');
  for (const char c : text) {
    if (c == '\'')
      result.append("'\\''");
    else
      result.push_back(c);
  }
  result.push_back('\'');
  return result;
}

constexpr int not_found = 127;

Said slurm(const std::string& command) {
  Said said = said_by(command);
  if (said.code == not_found)
    throw Error(ErrorKind::usage, "there is no Slurm on this machine (" + command.substr(0, command.find(' ')) +
                                      " was not found); --print-script shows what would be submitted");
  return said;
}

fs::path own_program() { return fs::read_symlink("/proc/self/exe"); }

std::string environment_lines() {
  std::string lines;
  for (const char* name : {"SUNDER_ASSETS", "SUNDER_MESHES"})
    if (const char* value = std::getenv(name))
      lines.append("export ").append(name).append("=").append(quoted(value)).append("\n");
  return lines;
}

struct Limits {
  std::uint64_t chunk;  ///< jobs of a task
  long minutes, memory_mb;
};

Limits limits_of(const JobForecast& forecast, const SlurmSettings& settings) {
  const double seconds = forecast.tried > 0 ? std::max(forecast.seconds, 1e-3) : unknown_seconds;
  Limits limits;
  limits.chunk = static_cast<std::uint64_t>(std::max(1.0, std::floor(60 * settings.task_minutes / seconds)));
  const double minutes = time_margin * seconds * static_cast<double>(limits.chunk) / 60;
  limits.minutes = std::lround(std::ceil(std::max(least_minutes, minutes + 1)));
  limits.memory_mb = std::lround(std::ceil(std::max(least_memory_mb, memory_margin * forecast.memory_mb)));
  return limits;
}

std::string script_of(const Plan& plan, const fs::path& out, const SlurmSettings& settings, const Limits& limits,
                      std::uint64_t offset) {
  const fs::path folder = fs::absolute(out);
  std::ostringstream script;
  script << "#!/bin/sh\n#SBATCH --job-name=" << quoted("sunder " + plan.name)
         << "\n#SBATCH --cpus-per-task=" << settings.threads
         << "\n#SBATCH --ntasks=1\n#SBATCH --mem=" << limits.memory_mb << "M\n#SBATCH --time=" << limits.minutes
         << "\n#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --output="
         << quoted((folder / "slurm" / "%A_%a.log").string()) << "\n"
         << environment_lines() << "first=$((" << offset << " + SLURM_ARRAY_TASK_ID * " << limits.chunk << "))\n"
         << "cd " << quoted(fs::current_path().string()) << " || exit 1\n"
         << "exec " << quoted(own_program().string()) << " batch " << quoted(plan.file.string()) << " --out "
         << quoted(folder.string()) << " --workers 1 --threads " << settings.threads << " --jobs \"$first-$((first + "
         << limits.chunk - 1 << "))\"\n";
  return script.str();
}

/// "0-3,7" of ascending numbers, in pieces that are not too long.
std::vector<std::pair<std::string, std::uint64_t>> ranges(const std::vector<std::uint64_t>& numbers) {
  std::vector<std::pair<std::string, std::uint64_t>> pieces;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    std::string range = std::to_string(numbers[i]);
    if (end - i > 1) range.append("-").append(std::to_string(numbers[end - 1]));
    if (pieces.empty() || pieces.back().first.size() + range.size() > longest_array) pieces.emplace_back("", 0);
    std::string& text = pieces.back().first;
    text.append(text.empty() ? "" : ",").append(range);
    pieces.back().second += end - i;
    i = end;
  }
  return pieces;
}

}  // namespace

std::vector<Submission> submissions(const Plan& plan, const fs::path& out, const std::vector<std::uint64_t>& pending,
                                    const JobForecast& forecast, const SlurmSettings& settings,
                                    std::uint64_t largest_index) {
  const Limits limits = limits_of(forecast, settings);
  const std::uint64_t window = largest_index + 1;
  std::map<std::uint64_t, std::vector<std::uint64_t>> tasks;  // by window
  for (const std::uint64_t job : pending) {
    const std::uint64_t task = job / limits.chunk;
    std::vector<std::uint64_t>& list = tasks[task / window];
    if (list.empty() || list.back() != task % window) list.push_back(task % window);
  }
  std::vector<Submission> result;
  for (const auto& [number, list] : tasks) {
    const std::string script = script_of(plan, out, settings, limits, number * window * limits.chunk);
    for (const auto& [range, count] : ranges(list)) {
      std::string array = range;
      if (settings.tasks_at_once > 0) array.append("%").append(std::to_string(settings.tasks_at_once));
      result.push_back({array, count, script});
    }
  }
  return result;
}

std::uint64_t largest_array_index() {
  const Said said = slurm("scontrol show config");
  const std::size_t at = said.text.find("MaxArraySize");
  const std::size_t number = at == std::string::npos ? at : said.text.find_first_of("0123456789", at);
  if (said.code != 0 || number == std::string::npos)
    throw Error(ErrorKind::usage, "Slurm does not say how large arrays may be: " + said.text);
  return std::max<std::uint64_t>(1, std::stoull(said.text.substr(number))) - 1;
}

std::vector<std::string> submit(const std::vector<Submission>& submissions, const fs::path& out) {
  const fs::path folder = out / "slurm";
  output::create_folder(folder);
  std::vector<std::string> numbers;
  for (const Submission& submission : submissions) {
    const fs::path draft = folder / "submission.sh";
    output::write_atomically(draft, submission.script);
    const Said said = slurm("sbatch --parsable --array=" + submission.array + " " + quoted(draft.string()));
    const std::string number = said.text.substr(0, said.text.find_first_of(";\n"));
    if (said.code != 0 || number.empty()) throw Error(ErrorKind::usage, "sbatch refused: " + said.text);
    numbers.push_back(number);
    fs::rename(draft, folder / (number + ".sh"));
    std::ofstream(folder / "submitted.txt", std::ios::app) << number << '\n';
  }
  return numbers;
}

std::vector<std::pair<std::string, std::uint64_t>> task_states(const fs::path& out) {
  std::ifstream in(out / "slurm" / "submitted.txt");
  std::map<std::string, std::uint64_t> count;
  for (std::string number; std::getline(in, number);) {
    const Said said = slurm("squeue --noheader --array --format=%T --jobs=" + number);
    if (said.code != 0) continue;  // forgotten: it ended long ago
    std::istringstream lines(said.text);
    for (std::string state; std::getline(lines, state);) ++count[state];
  }
  return {count.begin(), count.end()};
}

}  // namespace sunder::batch
