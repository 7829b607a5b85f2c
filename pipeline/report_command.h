#pragma once
/// `sunder report FOLDER`: the report page once more, of a run that is done.
#include <filesystem>

namespace sunder::pipeline {

/// Writes index.html and says where it is; the exit code. Errors: those of write_report_page.
int report_command(const std::filesystem::path& folder);

}  // namespace sunder::pipeline
