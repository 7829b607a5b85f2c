/// What a run's data become inside the page: nothing in them ends its element or is changed.
#include "pipeline/report_page.h"

#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "output/atomic_file.h"
#include "tests/output/scratch_folder.h"

namespace sunder::pipeline {
namespace {

using output::ScratchFolder;

const std::string report = R"({"scene": "cup", "fragments": {}})";

// What a browser takes for the text of a script element: all up to the first end tag.
std::string element(const std::string& page, const std::string& id) {
  const std::regex start("<script [^>]*id=\"" + id + "\"[^>]*>");
  std::smatch match;
  if (!std::regex_search(page, match, start)) return "no element " + id;
  const std::size_t begin = static_cast<std::size_t>(match.position() + match.length());
  return page.substr(begin, page.find("</script", begin) - begin);
}

TEST(ReportPage, TextThatLooksLikeMarkupStaysInItsElement) {
  const std::string evil = "</script><script>alert(1)</script> <!-- <script> \u2028 & &lt; ]]>";
  const nlohmann::json json = {{"scene", evil}, {"fragments", nullptr}};
  const std::string page = report_page(json.dump(), evil, "");
  const std::string carried = element(page, "report");
  EXPECT_EQ(nlohmann::json::parse(carried), json);
  EXPECT_EQ(carried.find('<'), std::string::npos);
  EXPECT_EQ(carried.find("\u2028"), std::string::npos);
  EXPECT_EQ(element(page, "scene"),
            "&lt;/script>&lt;script>alert(1)&lt;/script> &lt;!-- &lt;script> \u2028 &amp; &amp;lt; ]]>");
}

TEST(ReportPage, GeometryIsBase64) {
  // RFC 4648, section 10.
  const std::vector<std::pair<std::string, std::string>> vectors = {{"", ""},
                                                                    {"f", "Zg=="},
                                                                    {"fo", "Zm8="},
                                                                    {"foo", "Zm9v"},
                                                                    {"foob", "Zm9vYg=="},
                                                                    {"fooba", "Zm9vYmE="},
                                                                    {std::string("\xff\xfe\x00\xfb", 4), "//4A+w=="}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(element(report_page(report, "", bytes), "geometry"), text);
}

TEST(ReportPage, LargeGeometryIsLeftOutAndItsSizeSaid) {
  const std::string page = report_page(report, "", std::string(largest_page_geometry + 1, 'g'));
  EXPECT_EQ(element(page, "geometry"), "");
  EXPECT_NE(page.find("id=\"geometry\" data-bytes=\"200000001\""), std::string::npos);
  EXPECT_LT(page.size(), 3'000'000u);
}

TEST(ReportPage, AsksTheNetworkForNothing) {
  const std::string page = report_page(report, "", "");
  EXPECT_FALSE(std::regex_search(page, std::regex("<(link(?! rel=\"icon\" href=\"data:)|img|iframe|object|embed)[ "
                                                  ">]|<script[^>]* src|@import|url\\( *['\"]?http")));
  EXPECT_LT(page.size(), 3'000'000u);
}

TEST(ReportPage, IsMadeOfWhatIsInTheFolder) {
  const ScratchFolder folder;
  output::write_atomically(folder / "report.json", report);
  write_report_page(folder.path());
  EXPECT_EQ(output::read_all(folder / "index.html"), report_page(report, "", ""));
  output::write_atomically(folder / "scene.toml", "[ground]\n");
  output::write_atomically(folder / "fragments.glb", "glTF");
  write_report_page(folder.path());
  EXPECT_EQ(output::read_all(folder / "index.html"), report_page(report, "[ground]\n", "glTF"));
}

TEST(ReportPage, NeedsAReport) {
  const ScratchFolder folder;
  const auto kind = [&] {
    try {
      write_report_page(folder.path());
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::internal;
  };
  EXPECT_EQ(kind(), ErrorKind::io);
  for (const char* text : {"", "{", "[]", R"({"scene": "cup"})"}) {
    output::write_atomically(folder / "report.json", text);
    EXPECT_EQ(kind(), ErrorKind::io) << text;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "index.html"));
}

}  // namespace
}  // namespace sunder::pipeline
