#include "host/report/sweep_page.h"

#include "host/report/html_parts.h"
#include "host/report/html_text.h"
#include "host/report/number_text.h"
#include "host/report/palette.h"

namespace armada {
namespace {

std::string Text(const Json& value) {
  if (value.is_null()) return "–";
  if (value.is_string()) return HtmlEscaped(value.get<std::string>());
  if (value.is_number_float()) return NumberText(value.get<double>());
  return value.dump();
}

std::string Verdict(const RecordedSweep& sweep) {
  const Json& summary = sweep.summary;
  const std::string count = Text(summary.at("count"));
  const bool ok = summary.at("ok_count") == summary.at("count");
  std::string set;
  for (const Json& entry : summary.at("set")) set += (set.empty() ? "" : ", ") + Text(entry);
  std::string html = std::string("<div class=\"verdict") + (ok ? "" : " bad") + "\"><h1>" +
                     Text(summary.at("scenario")) + ": <b>" + Text(summary.at("ok_count")) + " of " + count +
                     " fleets ok</b></h1>";
  if (!summary.at("fleet_rms_mm").is_null()) {
    html += "<p>RMS of the fleets that are ok: " + Text(summary.at("fleet_rms_mm")) + " mm";
    if (summary.contains("floor_rms_mm")) {
      html += ", " + Text(summary.at("over_floor")) + " times the unavoidable " +
              Text(summary.at("floor_rms_mm")) + " mm";
    }
    html += ".</p>";
  }
  html += "</div>\n<dl>";
  const auto fact = [&](const std::string& name, const std::string& value) {
    html += "<div><dt>" + name + "</dt><dd>" + value + "</dd></div>";
  };
  fact("what was run", "armada sweep: virtual time, " + count + " seeds from " +
                           Text(summary.at("first_seed")) + " to " + Text(summary.at("last_seed")));
  fact("settings", set.empty() ? "the scenario's" : set);
  fact("estimator RMS", NumberText(1e3 * summary.at("estimator_rms_x").get<double>()) + " mm");
  fact("arms", std::to_string(sweep.arm_ids.size()));
  return html + "</dl>\n";
}

std::string Percentiles(const std::string& title, const std::vector<SweepFigure>& figures) {
  if (figures.empty()) return "";
  std::string html = "<h2>" + title + "</h2>\n<div class=\"wide\"><table><thead><tr><th scope=\"col\"></th>";
  for (const char* head : {"seeds", "median", "95 %", "99 %", "99.9 %", "worst", "worst seed"})
    html += std::string("<th scope=\"col\">") + head + "</th>";
  html += "</tr></thead><tbody>\n";
  for (size_t i = 0; i < figures.size(); ++i) {
    const SweepFigure& figure = figures[i];
    const bool fleet = i + 1 == figures.size();
    const std::string colour = fleet ? "currentColor" : ArmColour(i);
    html += "<tr><th scope=\"row\"><span class=\"swatch\" style=\"background:" + colour + "\"></span>" +
            figure.of + "</th>";
    double seeds = 0.0;
    for (const double count : figure.counts) seeds += count;
    html += "<td>" + std::to_string(static_cast<long long>(seeds)) + "</td>";
    for (const char* key : {"median", "p95", "p99", "p99.9", "max", "worst_seed"})
      html += "<td>" + (figure.distribution.is_null() ? "–" : Text(figure.distribution.at(key))) + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string WorstSeeds(const RecordedSweep& sweep) {
  std::string rows;
  for (const auto& [key, title] :
       {std::pair{"settled_s", "settled last [s]"}, std::pair{"rms_mm", "fleet RMS [mm]"},
        std::pair{"max_mm", "largest error [mm]"}}) {
    for (const Json& entry : sweep.summary.at("worst").at(key)) {
      rows += std::string("<tr><th scope=\"row\">") + title + "</th><td>" + Text(entry.at("value")) +
              "</td><td>" + Text(entry.at("seed")) + "</td><td>" + Text(entry.at("arm")) +
              "</td><td class=\"word\"><code>" + Text(entry.at("command")) + "</code></td></tr>\n";
    }
  }
  if (rows.empty()) return "";
  return "<h2>Worst seeds in which no arm diverged</h2>\n<div class=\"wide\"><table><thead><tr><th "
         "scope=\"col\">by</th>"
         "<th scope=\"col\">value</th><th scope=\"col\">seed</th><th scope=\"col\">arm</th>"
         "<th scope=\"col\" class=\"word\">again</th></tr></thead><tbody>\n" +
         rows + "</tbody></table></div>\n";
}

std::string Failures(const RecordedSweep& sweep) {
  const Json& seeds = sweep.summary.at("failed_seeds");
  if (seeds.empty()) return "";
  std::string html =
      "<h2>Not ok</h2>\n<p class=\"alarm\">" + Text(sweep.summary.at("failed_count")) + " seeds:</p>\n<p>";
  for (const Json& seed : seeds) html += Text(seed) + " ";
  if (sweep.summary.at("failed_count") > seeds.size()) html += "..";
  html +=
      "</p>\n<table><thead><tr><th scope=\"col\">arm</th><th scope=\"col\">diverged</th>"
      "<th scope=\"col\">never settled</th></tr></thead><tbody>\n";
  for (const Json& arm : sweep.summary.at("arms")) {
    html += "<tr><th scope=\"row\">" + Text(arm.at("id")) + "</th><td>" + Text(arm.at("diverged")) +
            "</td><td>" + Text(arm.at("never_settled")) + "</td></tr>\n";
  }
  return html + "</tbody></table>\n<p>The first of them again: <code>" + Text(sweep.summary.at("replay")) +
         " " + Text(seeds.front()) + "</code></p>\n";
}

}  // namespace

std::string SweepPage(const RecordedSweep& sweep, const std::vector<Figure>& figures,
                      const std::filesystem::path& folder) {
  std::string html = PageOpening("Armada: sweep of " + Text(sweep.summary.at("scenario"))) + Verdict(sweep) +
                     Percentiles("Settling time [s]", sweep.settled_s) +
                     Percentiles("RMS error [mm]", sweep.rms_mm) +
                     Percentiles("RMS error by the unavoidable one", sweep.over_floor) +
                     Percentiles("Largest error [mm]", sweep.max_mm) + WorstSeeds(sweep) + Failures(sweep) +
                     "<h2>Figures</h2>\n";
  for (size_t i = 0; i < figures.size(); ++i) html += FigureElement(figures[i], i + 1, folder);
  return html + "</body></html>\n";
}

}  // namespace armada
