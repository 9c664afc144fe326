#include "cli/batch_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/page.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;
using batch::Record;

constexpr size_t most_cards = 400;  // pictures on the page, the doubtful ones first
constexpr size_t most_names = 50;   // heads named for each cause

struct Percentile {
  const char* name;
  double share;
};
constexpr Percentile percentiles[] = {{"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"most", 1.0}};

/// The value that `share` of the values do not exceed (nearest rank).
double percentile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0.0;
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<size_t>(rank, 1, sorted.size()) - 1];
}

/// What is summed up of all heads that have a rig.
struct Quantity {
  const char *key, *title;
  double (*of)(const Record&);
  int digits;
};
constexpr Quantity quantities[] = {
    {"seconds", "seconds a head, all steps", [](const Record& r) { return r.seconds; }, 2},
    {"cpu_seconds", "processor seconds a head", [](const Record& r) { return r.cpu_seconds; }, 2},
    {"megabytes", "largest memory, MB", [](const Record& r) { return r.megabytes; }, 0},
    {"rig_megabytes", "rig file, MB", [](const Record& r) { return 1e-6 * static_cast<double>(r.rig_bytes); },
     2}};

std::vector<double> sorted_values(const std::vector<Record>& records, const Quantity& quantity) {
  std::vector<double> values;
  for (const Record& record : records)
    if (record.is_done) values.push_back(quantity.of(record));
  std::sort(values.begin(), values.end());
  return values;
}

/// Names with how often, the most frequent first.
std::vector<std::pair<std::string, std::vector<std::string>>> ranked(
    const std::map<std::string, std::vector<std::string>>& groups) {
  std::vector<std::pair<std::string, std::vector<std::string>>> list(groups.begin(), groups.end());
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  return list;
}

auto causes(const std::vector<Record>& records) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const Record& record : records)
    if (!record.is_done) groups[record.cause].push_back(record.id);
  return ranked(groups);
}

auto failed_checks(const std::vector<Record>& records) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const Record& record : records)
    for (const std::string& check : record.failed_checks)
      groups[check].push_back(record.id);
  return ranked(groups);
}

std::string names(const std::vector<std::string>& ids) {
  std::string text;
  for (size_t i = 0; i < std::min(ids.size(), most_names); ++i)
    text += (i > 0 ? ", " : "") + escaped_markup(ids[i]);
  return ids.size() > most_names ? text + " and " + std::to_string(ids.size() - most_names) + " more" : text;
}

std::string groups_part(const std::string& title,
                        const std::vector<std::pair<std::string, std::vector<std::string>>>& groups) {
  if (groups.empty()) return "";
  std::string out = "<h2>" + title + "</h2>\n<table>\n";
  for (const auto& [what, ids] : groups)
    out += "<tr><td>" + escaped_markup(what) + "</td><td class=n>" + std::to_string(ids.size()) +
           "</td><td>" + names(ids) + "</td></tr>\n";
  return out + "</table>\n";
}

std::string card(const Record& record) {
  std::string out = "<div style=\"width:250px\"><img width=240 height=240 loading=lazy alt=\"\" src=\"" +
                    escaped_markup(record.id) + "/thumbnail.png\"><br>" + escaped_markup(record.id) + "<br>";
  if (record.failed_checks.empty())
    return out +
           (record.checks < 0 ? "not checked" : "all " + std::to_string(record.checks) + " checks hold") +
           "</div>\n";
  out += "<span class=far>" + std::to_string(record.failed_checks.size()) + " checks fail:</span> ";
  for (size_t i = 0; i < record.failed_checks.size(); ++i)
    out += (i > 0 ? ", " : "") + escaped_markup(record.failed_checks[i]);
  return out + "</div>\n";
}

}  // namespace

Json batch_figures(const std::vector<Record>& records) {
  const auto done = std::count_if(records.begin(), records.end(), [](const Record& r) { return r.is_done; });
  Json json = {{"heads", records.size()},
               {"done", done},
               {"failed", static_cast<std::ptrdiff_t>(records.size()) - done},
               {"causes", Json::array()}};
  for (const auto& [cause, ids] : causes(records))
    json["causes"].push_back({{"cause", cause}, {"heads", ids}});
  for (const Quantity& quantity : quantities) {
    const std::vector<double> values = sorted_values(records, quantity);
    for (const Percentile& wanted : percentiles)
      json[quantity.key][wanted.name] = percentile(values, wanted.share);
  }
  json["checks"] = Json::array();
  for (const auto& [check, ids] : failed_checks(records))
    json["checks"].push_back({{"name", check}, {"failed", ids.size()}});
  return json;
}

std::string batch_page(const std::string& title, const std::vector<Record>& records) {
  const Json figures = batch_figures(records);
  std::vector<const Record*> done;
  for (const Record& record : records)
    if (record.is_done) done.push_back(&record);
  std::string body = "<p>" + std::to_string(records.size()) + " heads: " + std::to_string(done.size()) +
                     " rigs, " + std::to_string(records.size() - done.size()) + " failures.</p>\n";
  body += groups_part("Failures by cause", causes(records));
  body += groups_part("Checks that fail", failed_checks(records));
  body += "<h2>Cost</h2>\n<table>\n" + page::row({"", "median", "90 %", "99 %", "most"}, "th");
  for (const Quantity& quantity : quantities) {
    std::vector<std::string> cells = {quantity.title};
    for (const Percentile& wanted : percentiles)
      cells.push_back(page::number(figures[quantity.key][wanted.name], quantity.digits));
    body += page::row(cells);
  }
  body += "</table>\n<h2>Rigs</h2>\n";
  std::stable_sort(done.begin(), done.end(), [](const Record* a, const Record* b) {
    return a->failed_checks.size() > b->failed_checks.size();
  });
  if (done.size() > most_cards)
    body += "<p class=cap>The " + std::to_string(most_cards) + " of which most checks fail.</p>\n";
  body += "<div class=views>\n";
  for (size_t i = 0; i < std::min(done.size(), most_cards); ++i)
    body += card(*done[i]);
  return page::whole(title, body + "</div>\n");
}

}  // namespace fascia::cli
