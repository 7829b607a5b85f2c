#include "pipeline/report_command.h"

#include <iostream>

#include "pipeline/report_page.h"

namespace sunder::pipeline {

int report_command(const std::filesystem::path& folder) {
  write_report_page(folder);
  std::cout << "written to " << (folder / "index.html").string() << std::endl;
  return 0;
}

}  // namespace sunder::pipeline
