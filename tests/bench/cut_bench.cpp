/// Speed, memory and exactness of the cut: one table, and with --json FILE the same numbers by key. Times are medians
/// of several runs, each in a process of its own, so that its peak of memory is known.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "geometry/cut.h"
#include "geometry/load.h"
#include "tests/geometry/delaunay_regions.h"
#include "tests/geometry/shapes.h"

namespace {

using namespace sunder;
using namespace sunder::geometry;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr int phase_count = 7;
constexpr const char* phase_names[phase_count] = {"check input", "find crossings",  "label", "check parts",
                                                  "assemble",    "check fragments", "after"};

/// Notes when each phase of the cut begins. A nudge begins anew; the last attempt is what remains.
class Phases final : public Progress {
 public:
  void report(std::string_view, double fraction) override {
    constexpr double begins[] = {0, 0.1, 0.4, 0.5, 0.7, 0.8, 1};
    for (int i = 0; i < phase_count; ++i) {
      if (fraction == begins[i]) at_[i] = Clock::now();
    }
  }
  bool cancelled() const override { return false; }
  double seconds(int phase) const { return std::chrono::duration<double>(at_[phase + 1] - at_[phase]).count(); }

 private:
  Clock::time_point at_[phase_count]{};
};

struct Measured {
  int ok = 0, nudges = 0, fragments = 0, faces = 0;
  double seconds = 0, megabytes = 0, volume_error = 0;
  double phase[phase_count - 1] = {};
};

double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0;
  while (status >> word) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return kilobytes / 1024;
}

Measured measure(const TriangleMesh& body, const RegionBoundary& regions, std::size_t threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  Phases phases;
  const auto start = Clock::now();
  const CutResult result = cut(body, regions, {}, phases);
  Measured measured;
  measured.seconds = seconds_since(start);
  measured.megabytes = peak_megabytes();
  measured.ok = result.status == CutStatus::ok;
  measured.nudges = result.nudges;
  measured.volume_error = result.volume_error;
  measured.fragments = static_cast<int>(result.fragments.size());
  for (const Fragment& fragment : result.fragments) measured.faces += static_cast<int>(fragment.mesh.faces.size());
  for (int i = 0; i + 1 < phase_count; ++i) measured.phase[i] = phases.seconds(i);
  if (!measured.ok) std::fprintf(stderr, "the cut failed: %s\n", result.detail.c_str());
  return measured;
}

/// In a child: regions and body are read from files so that nothing else counts as its memory.
Measured in_child(const std::function<Measured()>& work) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    const Measured measured = work();
    const bool written = write(ends[1], &measured, sizeof measured) == static_cast<ssize_t>(sizeof measured);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Measured measured;
  if (read(ends[0], &measured, sizeof measured) != static_cast<ssize_t>(sizeof measured)) measured.ok = 0;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  return measured;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Table {
  nlohmann::ordered_json json;

  void add(const std::string& key, double value, const char* unit, const std::string& what) {
    json[key] = value;
    std::printf("%-28s %9.3g %-3s %s\n", key.c_str(), value, unit, what.c_str());
    std::fflush(stdout);
  }
};

}  // namespace

int main(int argc, char** argv) {
  std::string file;
  if (argc == 3 && std::string(argv[1]) == "--json")
    file = argv[2];
  else if (argc != 1)
    return std::fprintf(stderr, "usage: cut_bench [--json FILE]\n"), 2;

  constexpr int repetitions = 5;
  Table table;
  double worst_error = 0;
  int failed = 0, nudges = 0;
  for (const int count : {50, 200, 1000}) {
    const std::string name = "cut_bunny_" + std::to_string(count);
    // The complex is made in a child as well, so this process stays small.
    const auto run = [&](std::size_t threads) {
      std::vector<Measured> all;
      for (int n = 0; n < repetitions; ++n) {
        all.push_back(in_child([&] {
          const TriangleMesh body = load_mesh(sample_mesh("bunny00.off"));
          return measure(body, cell_regions(body, count, 3, 1), threads);
        }));
        worst_error = std::max(worst_error, all.back().volume_error);
        failed += !all.back().ok;
        nudges += all.back().nudges;
      }
      return all;
    };
    const auto seconds_of = [](const std::vector<Measured>& all) {
      std::vector<double> seconds;
      for (const Measured& m : all) seconds.push_back(m.seconds);
      return median(seconds);
    };
    const std::vector<Measured> two = run(2), one = run(1);
    const Measured& last = two.back();
    table.add(name + "_seconds", seconds_of(two), "s",
              std::to_string(last.fragments) + " fragments of " + std::to_string(last.faces) + " faces, 2 threads");
    table.add(name + "_scaling_2t", seconds_of(one) / seconds_of(two), "", "1 thread over 2");
    table.add(name + "_mb", last.megabytes, "MB", "peak of the whole process, the regions' Delaunay included");
    for (int i = 0; i + 1 < phase_count; ++i) std::printf("    %-24s %9.3g s\n", phase_names[i], last.phase[i]);
  }
  table.add("cut_volume_error", worst_error, "", "fragments against the body, worst of all cuts");
  table.add("cut_failed", failed, "", "cuts that did not end well");
  table.add("cut_nudges", nudges, "", "of all cuts");
  if (file.empty()) return 0;
  std::ofstream(file) << table.json.dump(2) << "\n";
  return 0;
}
