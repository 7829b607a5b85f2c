#pragma once
/// Values from elsewhere in the document of a scene.
#include "pipeline/detail/toml_reader.h"
#include "pipeline/scene.h"

namespace sunder::pipeline::detail {

/// The value of TOML text. Errors: ErrorKind::usage naming `subject`.
toml::table parsed_value(const std::string& subject, const std::string& value);

/// Sets the value in the document. A section that takes no names is made when it is missing. Errors: ErrorKind::usage
/// for a key that leads nowhere and a value that is no TOML.
void apply(const Override& change, const std::filesystem::path& file, toml::table& document);

}  // namespace sunder::pipeline::detail
