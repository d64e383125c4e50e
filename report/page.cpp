#include "report/page.h"

#include <array>
#include <string_view>
#include <utility>

#include "physics/core/error.h"
#include "physics/core/schema.h"
#include "report/page_template.h"
#include "study/version.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

// Where web/template.html has its document and the numbers of it.
constexpr std::string_view kDocument = "@CROSSGAIT_DOCUMENT@", kNumbers = "@CROSSGAIT_NUMBERS@",
                           kConnect = "@CROSSGAIT_CONNECT@";

/// The template with each of its places filled. They come in this order.
/// @param connect  further words of the content security policy
std::string filled_page(std::string_view connect, std::string_view document, std::string_view numbers) {
  const std::string_view html = page_template();
  std::string text;
  std::size_t from = 0;
  const auto fill = [&](std::string_view place, std::string_view with) {
    const std::size_t at = html.find(place, from);
    text += html.substr(from, at - from);
    text += with;
    from = at + place.size();
  };
  fill(kConnect, connect);
  fill(kDocument, document);
  fill(kNumbers, numbers);
  return text.append(html.substr(from));
}

ordered_json to_json(const IntervalColumn& column) {
  ordered_json rows = ordered_json::array();
  for (const auto& row : column.rows) {
    rows.push_back(row ? ordered_json{{"estimate", row->estimate}, {"low", row->low}, {"high", row->high}}
                       : ordered_json());
  }
  return {{"label", column.label}, {"rows", std::move(rows)}};
}

constexpr std::array<const char*, 4> kMarks{"", "good", "mixed", "bad"};

ordered_json to_json(const PageTable& table) {
  const auto& rows = table.table.rows();
  ordered_json marks = ordered_json::array();
  for (const std::vector<Mark>& row : table.marks) {
    ordered_json cells = ordered_json::array();
    for (const Mark mark : row) cells.push_back(kMarks[static_cast<std::size_t>(mark)]);
    marks.push_back(std::move(cells));
  }
  return {{"title", table.title},
          {"note", table.note},
          {"header", rows.front()},
          {"rows", std::vector<std::vector<std::string>>(rows.begin() + 1, rows.end())},
          {"marks", std::move(marks)},
          {"intervals", table.intervals ? to_json(*table.intervals) : ordered_json()}};
}

}  // namespace

void require_page() {
  if (page_template().empty()) {
    throw ConfigError("report", "page",
                      "a Crossgait that was built with Node.js (CMake: CROSSGAIT_WITH_PAGE)", "one without");
  }
}

nlohmann::ordered_json report_document(const ReportPage& page, PageNumbers& numbers) {
  ordered_json document{{"title", page.title},
                        {"crossgait", crossgait_version()},
                        {"summary", page.summary},
                        {"groups", page.groups},
                        {"sentences", page.sentences},
                        {"motions", ordered_json::array()},
                        {"tables", ordered_json::array()},
                        {"charts", ordered_json::array()},
                        {"texts", page.texts},
                        {"verdicts", page.verdicts},
                        {"provenances", page.provenances}};
  for (const Motion& motion : page.motions) document["motions"].push_back(motion_document(motion, numbers));
  for (const PageTable& table : page.tables) document["tables"].push_back(to_json(table));
  for (const Charts& charts : page.charts) document["charts"].push_back(to_json(charts, numbers));
  return with_schema("report", document);
}

std::string script_text(const nlohmann::ordered_json& json) {
  // Names from files may hold anything, bytes that are no UTF-8 as well.
  const std::string plain = json.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
  std::string text;
  text.reserve(plain.size());
  for (const char c : plain) {
    // Outside its strings JSON has none of these.
    if (c == '<') {
      text += "\\u003c";
    } else if (c == '>') {
      text += "\\u003e";
    } else if (c == '&') {
      text += "\\u0026";
    } else {
      text += c;
    }
  }
  return text;
}

std::string report_html(const ReportPage& page) {
  require_page();
  PageNumbers numbers;
  const std::string document = script_text(report_document(page, numbers));
  return filled_page("", document, numbers.base64());
}

std::string live_page() {
  require_page();
  return filled_page("; connect-src 'self'",
                     script_text({{"live", true}, {"crossgait", crossgait_version()}}), "");
}

}  // namespace crossgait
