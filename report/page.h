// One HTML file that shows what a command found: the motion in 3D, plots, statistics, where it comes from.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "parity/paired_test.h"
#include "physics/core/table.h"
#include "report/chart.h"
#include "report/motion_document.h"

namespace crossgait {

/// Says what a cell of a table means, for who does not read it.
enum class Mark { kNone, kGood, kMixed, kBad };

/// Describes a column of estimates with their intervals, drawn as bars over one axis.
struct IntervalColumn {
  std::string label;                          ///< with its unit
  std::vector<std::optional<Interval>> rows;  ///< as many as the table has
};

/// Holds a table of a page.
struct PageTable {
  Table table;             ///< its header: first the heading, then a name per run
  std::string title = {};  ///< of one that is part of the answer, which stands in front of all else
  std::string note = {};   ///< a sentence below the title
  std::vector<std::vector<Mark>> marks = {};  ///< of the cells, row by row; empty: of none
  std::optional<IntervalColumn> intervals = {};
};

struct ReportPage {
  std::string title;
  std::string summary;                 ///< the answer, to repeat to a colleague; empty if there is none
  std::vector<std::string> groups;     ///< a line each for engines that did the same
  std::vector<std::string> sentences;  ///< what else was found, in words
  std::vector<Motion> motions;         ///< replays, of which one is shown at a time
  std::vector<PageTable> tables;
  std::vector<Charts> charts;                       ///< what is no plot over the motion's time
  std::vector<std::string> texts;                   ///< as a command prints it, in lines
  std::vector<nlohmann::ordered_json> verdicts;     ///< as `verdict_document` makes them
  std::vector<nlohmann::ordered_json> provenances;  ///< of each result, as commands write it
};

/// @throws ConfigError if Crossgait was built without the page, before anything long is done for one
void require_page();

/// Writes the document within the page: `schema` ("report", 2), the members above, `crossgait` (the version)
/// and `motions` as `motion_document` makes them. Numbers of it are in `numbers`.
nlohmann::ordered_json report_document(const ReportPage& page, PageNumbers& numbers);

/// Writes `json` in a form that a `script` element can hold: it ends no element and begins no comment,
/// whatever it says.
std::string script_text(const nlohmann::ordered_json& json);

/// Returns the page that shows what a server simulates (view/server.h): the same template without a report,
/// which may ask the server that it came from, and nobody else. @throws ConfigError as `require_page`
std::string live_page();

/// Writes the page. @throws ConfigError as `require_page` and `motion_document` do
std::string report_html(const ReportPage& page);

}  // namespace crossgait
