#pragma once
/// All pieces of a sequence as one table.
#include <filesystem>

#include "output/sequence.h"

namespace sunder::output {

/// A row for every piece, bodies of the scene too, by id: RFC 4180 (CRLF; names with commas, quotes or line ends are
/// quoted), every digit, units in the names of the columns; docs/outputs.md explains them. Cells without a value are
/// empty: the parent of a body, the death of a piece that lives, the shape of what is no closed solid. Errors:
/// ErrorKind::io with the file and the system's reason, ErrorKind::internal for a number that is not finite.
void write_fragments_csv(const Sequence& sequence, const std::filesystem::path& file);

}  // namespace sunder::output
