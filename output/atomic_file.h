#pragma once
/// Files that are whole or not there.
#include <filesystem>
#include <functional>
#include <iosfwd>
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

/// The same for what is too large to be held in memory once more: `write` puts it into a stream. What `write` throws
/// goes on to the caller; the temporary file is removed then, too.
void write_atomically(const std::filesystem::path& file, const std::function<void(std::ostream&)>& write);

/// Removes the temporary files that processes left behind which were killed as they wrote to the folder.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace sunder::output
