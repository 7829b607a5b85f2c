#pragma once
/// Pages for people, without scripts.
#include <string>

namespace sunder::output {

/// A page in one file, readable without network and on light and dark ground. `title` and `note`, a line under it, are
/// texts; `body` is HTML.
std::string plain_page(const std::string& title, const std::string& note, const std::string& body);

}  // namespace sunder::output
