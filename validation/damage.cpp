#include "validation/catalogue.h"

namespace sunder::validation {

std::vector<Problem> damage() { return {}; }

}  // namespace sunder::validation
