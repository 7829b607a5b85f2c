#pragma once
/// A batch on one page.
#include <filesystem>

namespace sunder::batch {

/// True when the folder holds the manifest of a batch.
bool is_batch(const std::filesystem::path& folder);

/// Writes index.html from the manifest: outcomes, fragments against what was varied, sizes, energy, failures by reason,
/// stills, time and disk. Pictures are linked, so the page belongs into its folder. Errors: ErrorKind::io.
void write_batch_page(const std::filesystem::path& folder);

}  // namespace sunder::batch
