#include "host/report/draw.h"

#include <fstream>

#include "host/report/gnuplot.h"
#include "host/report/report_error.h"

namespace armada {
namespace {

void WriteFile(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush()) throw ReportError(path.string() + ": cannot be written");
}

}  // namespace

void Draw(const Figure& figure, const std::string& script, const std::filesystem::path& folder) {
  const std::string script_name = figure.name + ".gp";
  WriteFile(folder / script_name, script);
  const std::filesystem::path pictures[] = {folder / (figure.name + ".svg"), folder / (figure.name + ".png")};
  for (const auto& picture : pictures) std::filesystem::remove(picture);
  try {
    RunGnuplot(folder, script_name);
    for (const auto& picture : pictures) {
      if (!std::filesystem::exists(picture)) throw ReportError("gnuplot did not write " + picture.string());
    }
  } catch (const ReportError&) {
    for (const auto& picture : pictures) std::filesystem::remove(picture);
    throw;
  }
}

void WritePage(const std::string& html, const std::filesystem::path& folder,
               const std::filesystem::path& page) {
  const std::filesystem::path unfinished = folder / "report.html.part";
  WriteFile(unfinished, html);
  std::filesystem::rename(unfinished, page);
}

}  // namespace armada
