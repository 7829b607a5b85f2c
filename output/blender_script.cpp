#include <string_view>

#include "output/atomic_file.h"
#include "output/writers.h"

namespace sunder::output {
namespace detail {

extern const std::string_view blender_script;  // output/import_blender.py

}  // namespace detail

void write_blender_script(const std::filesystem::path& dir) {
  write_atomically(dir / "import_blender.py", detail::blender_script);
}

}  // namespace sunder::output
