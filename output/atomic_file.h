#pragma once
/// Files that are whole or not there.
#include <filesystem>
#include <string_view>

namespace sunder::output {

/// With its parents; one that is there is fine. Errors: ErrorKind::io.
void create_folder(const std::filesystem::path& folder);

/// That files can be written to the folder, or that it can be created; leaves everything as it is. Errors:
/// ErrorKind::io with the system's reason.
void require_writable(const std::filesystem::path& folder);

/// Replaces `file` by `text` through a temporary file in the same folder (rename), so a reader or a full disk never
/// sees half of it. Errors: ErrorKind::io with the system's reason; the temporary file is removed.
void write_atomically(const std::filesystem::path& file, std::string_view bytes);

/// Removes the temporary files that processes left behind which were killed as they wrote to the folder.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace sunder::output
