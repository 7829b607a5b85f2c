/// Any bytes as a plan of a batch: it is read, or refused by an Error.
#include "batch/plan.h"
#include "core/error.h"
#include "tests/fuzz/bytes.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sunder;
  const fuzz::MemoryFile file(data, size);
  try {
    const batch::Plan plan = batch::load_plan(file.path());
    fuzz::require(plan.size() > 0, "a plan that is read has a job");
    fuzz::require(!plan.axes.empty(), "the subject is an axis");
    fuzz::require(plan.points >= 0 && plan.job_time_limit >= 0, "limits are not below zero");
  } catch (const Error& error) {
    fuzz::require(error.kind() != ErrorKind::internal, "bad input is no defect of the program");
    fuzz::require(error.what()[0] != '\0', "an error says something");
  }
  return 0;
}
