#include "host/report/html_parts.h"

#include "host/report/html_text.h"
#include "host/report/page_style.h"

namespace armada {

std::string PageOpening(const std::string& title) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         title + "</title>\n<style>" + kPageStyle + "</style></head>\n<body>\n";
}

std::string FigureElement(const Figure& figure, size_t number, const std::filesystem::path& folder) {
  const std::string file = HtmlEscaped((folder.filename() / figure.name).string());
  return "<figure id=\"" + figure.name + "\"><div class=\"wide picture\">" +
         InlineSvg(folder / (figure.name + ".svg"), figure.name, figure.title) +
         "</div>\n<figcaption><b>Figure " + std::to_string(number) + ". " + HtmlEscaped(figure.title) +
         ".</b> " + HtmlEscaped(figure.caption) + " <code>" + file +
         ".svg</code>, <code>.png</code>, drawn by <code>" + file + ".gp</code></figcaption></figure>\n";
}

}  // namespace armada
