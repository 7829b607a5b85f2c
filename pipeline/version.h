#pragma once
/// Which program this is.
#include <string>

namespace sunder::pipeline {

/// "0.1.0 (1dfab9912345)": version and git revision, with "-dirty" when files of the checkout had changed.
std::string build_name();

}  // namespace sunder::pipeline
