#include "core/resources.h"

#include <array>
#include <ctime>
#include <fstream>
#include <thread>

#include <sys/resource.h>
#include <unistd.h>

namespace sunder {
namespace {

/// What follows `key` and a colon in a file of /proc; empty: there is no such line.
std::string line_of(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t colon = line.find(':');
    const std::size_t first = line.find_first_not_of(" \t", colon + 1);
    if (colon != std::string::npos && first != std::string::npos) return line.substr(first);
  }
  return {};
}

}  // namespace

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  rusage children{};
  getrusage(RUSAGE_CHILDREN, &children);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) + seconds(children.ru_utime) +
         seconds(children.ru_stime);
}

double peak_memory_mb() {
  const std::string peak = line_of("/proc/self/status", "VmHWM");
  if (!peak.empty()) return std::stod(peak) / 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

bool restart_peak_memory() {
  std::ofstream clear("/proc/self/clear_refs");
  clear << "5" << std::flush;
  return static_cast<bool>(clear);
}

Machine machine() {
  const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)), page = static_cast<double>(sysconf(_SC_PAGESIZE));
  std::string name = line_of("/proc/cpuinfo", "model name");
  return {name.empty() ? "unknown processor" : std::move(name), static_cast<int>(std::thread::hardware_concurrency()),
          pages * page / 1e9};
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

double available_memory_mb() {
  const std::string available = line_of("/proc/meminfo", "MemAvailable");
  return available.empty() ? 1e3 * machine().memory_gb : std::stod(available) / 1024;
}

}  // namespace sunder
