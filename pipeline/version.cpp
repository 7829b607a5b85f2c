#include "pipeline/version.h"

#include "sunder_version.h"

namespace sunder::pipeline {

std::string build_name() { return std::string(SUNDER_VERSION) + " (" + SUNDER_GIT + ")"; }

}  // namespace sunder::pipeline
