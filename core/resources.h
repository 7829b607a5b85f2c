#pragma once
/// What this process takes, and the machine that it runs on.
#include <string>

namespace sunder {

/// Processor time of all threads since the start of the process, and of its children that have ended [s].
double cpu_seconds();

/// Most memory that the process has held at once since its start, or since restart_peak_memory() [MB].
double peak_memory_mb();
/// False where the system cannot do that: peak_memory_mb() then goes on to count from the start of the process.
bool restart_peak_memory();

struct Machine {
  std::string processor;  ///< as the system calls it
  int threads = 0;
  double memory_gb = 0;
};
Machine machine();

/// Of this machine in its network.
std::string host_name();

/// Memory that programs can still take [MB].
double available_memory_mb();

}  // namespace sunder
