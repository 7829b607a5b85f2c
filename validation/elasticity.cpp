#include "validation/catalogue.h"

namespace sunder::validation {

std::vector<Problem> elasticity() { return {}; }

}  // namespace sunder::validation
