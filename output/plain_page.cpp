#include "output/plain_page.h"

#include "output/chart.h"

namespace sunder::output {

std::string plain_page(const std::string& title, const std::string& note, const std::string& body) {
  std::string page =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page.append("<title>").append(escaped_xml(title)).append("</title>\n");
  page +=
      "<style>:root{color-scheme:light dark}body{font:15px/1.5 sans-serif;max-width:1180px;margin:2rem auto;padding:0 "
      "1rem}table{border-collapse:collapse;font-size:13px;width:100%}td,th{padding:3px 8px;text-align:left;"
      "border-bottom:1px solid #8884}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}.fail{color:#c0392b;"
      "font-weight:bold}.grid{display:flex;flex-wrap:wrap;gap:1rem}.grid>*{flex:1 1 520px}svg,img{max-width:100%;"
      "height:auto}.note{color:#777}.scroll{overflow-x:auto}</style>\n</head>\n<body>\n";
  page.append("<h1>").append(escaped_xml(title)).append("</h1>\n");
  page.append("<p class=\"note\">").append(escaped_xml(note)).append("</p>\n");
  return page.append(body).append("</body>\n</html>\n");
}

}  // namespace sunder::output
