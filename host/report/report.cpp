#include "host/report/report.h"

#include <functional>
#include <vector>

#include "host/report/draw.h"
#include "host/report/figures.h"
#include "host/report/html_page.h"
#include "host/report/report_error.h"
#include "host/report/sweep_figures.h"
#include "host/report/sweep_page.h"

namespace armada {
namespace {

std::vector<Figure> Figures(const RecordedRun& run, const std::filesystem::path& folder) {
  std::vector<Figure> figures = TaskSpaceFigures(run);
  for (Figure& figure : SubtaskFigures(run)) figures.push_back(std::move(figure));
  figures.push_back(ErrorFigure(run, folder));
  figures.push_back(TorqueFigure(run));
  if (run.timing) figures.push_back(TimingFigure(run));
  return figures;
}

void WriteReportOrThrow(const std::filesystem::path& dir) {
  const std::filesystem::path page = dir / "report.html";
  std::filesystem::remove(page);
  const RecordedRun run = LoadRecordedRun(dir);
  const std::filesystem::path folder = dir / "report";
  std::filesystem::create_directories(folder);
  const std::vector<Figure> figures = Figures(run, folder);
  for (const Figure& figure : figures) Draw(figure, ScriptText(figure, run), folder);
  WritePage(HtmlPage(run, figures, folder), folder, page);
}

void WriteSweepReportOrThrow(const std::filesystem::path& file) {
  if (file.extension() != ".json") throw ReportError(file.string() + ": a sweep's file ends in .json");
  std::filesystem::path page = file;
  page.replace_extension(".html");
  std::filesystem::remove(page);
  const RecordedSweep sweep = LoadRecordedSweep(file);
  std::filesystem::path folder = file;
  folder.replace_extension(".report");
  std::filesystem::create_directories(folder);
  const std::vector<Figure> figures = SweepFigures(sweep, folder);
  for (const Figure& figure : figures) Draw(figure, ScriptText(figure, sweep), folder);
  WritePage(SweepPage(sweep, figures, folder), folder, page);
}

bool Succeeds(const std::function<void()>& write, std::string* error) {
  try {
    write();
    return true;
  } catch (const std::exception& problem) {
    *error = problem.what();
    return false;
  }
}

}  // namespace

bool WriteReport(const std::filesystem::path& dir, std::string* error) {
  return Succeeds([&] { WriteReportOrThrow(dir); }, error);
}

bool WriteSweepReport(const std::filesystem::path& sweep, std::string* error) {
  return Succeeds([&] { WriteSweepReportOrThrow(sweep); }, error);
}

}  // namespace armada
