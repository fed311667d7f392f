#include "host/report/report.h"

#include <fstream>
#include <vector>

#include "host/report/figures.h"
#include "host/report/gnuplot.h"
#include "host/report/html_page.h"
#include "host/report/report_error.h"

namespace armada {
namespace {

void WriteFile(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw ReportError(path.string() + ": cannot be written");
}

std::vector<Figure> Figures(const RecordedRun& run, const std::filesystem::path& folder) {
  std::vector<Figure> figures = TaskSpaceFigures(run);
  for (Figure& figure : SubtaskFigures(run)) figures.push_back(std::move(figure));
  figures.push_back(ErrorFigure(run, folder));
  figures.push_back(TorqueFigure(run));
  if (run.timing) figures.push_back(TimingFigure(run));
  return figures;
}

/// Draws <name>.svg and <name>.png; where that fails only the script stays, to be looked at.
void Draw(const Figure& figure, const RecordedRun& run, const std::filesystem::path& folder) {
  const std::string script = figure.name + ".gp";
  WriteFile(folder / script, ScriptText(figure, run));
  const std::filesystem::path pictures[] = {folder / (figure.name + ".svg"), folder / (figure.name + ".png")};
  for (const auto& picture : pictures) std::filesystem::remove(picture);
  try {
    RunGnuplot(folder, script);
    for (const auto& picture : pictures) {
      if (!std::filesystem::exists(picture)) throw ReportError("gnuplot did not write " + picture.string());
    }
  } catch (const ReportError&) {
    for (const auto& picture : pictures) std::filesystem::remove(picture);
    throw;
  }
}

void WriteReportOrThrow(const std::filesystem::path& dir) {
  const std::filesystem::path page = dir / "report.html";
  std::filesystem::remove(page);
  const RecordedRun run = LoadRecordedRun(dir);
  const std::filesystem::path folder = dir / "report";
  std::filesystem::create_directories(folder);
  const std::vector<Figure> figures = Figures(run, folder);
  for (const Figure& figure : figures) Draw(figure, run, folder);

  const std::filesystem::path unfinished = folder / "report.html.part";
  WriteFile(unfinished, HtmlPage(run, figures, folder));
  std::filesystem::rename(unfinished, page);
}

}  // namespace

bool WriteReport(const std::filesystem::path& dir, std::string* error) {
  try {
    WriteReportOrThrow(dir);
    return true;
  } catch (const std::exception& problem) {
    *error = problem.what();
    return false;
  }
}

}  // namespace armada
