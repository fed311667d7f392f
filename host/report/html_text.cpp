#include "host/report/html_text.h"

#include <fstream>
#include <iterator>

#include "host/report/report_error.h"

namespace armada {
namespace {

void ReplaceAll(std::string* text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text->find(from, at)) != std::string::npos; at += to.size()) {
    text->replace(at, from.size(), to);
  }
}

/// The value of `attribute="..."` within `tag`; empty where it is absent.
std::string Attribute(const std::string& tag, const std::string& attribute) {
  const std::string start = attribute + "=\"";
  const size_t begin = tag.find(start);
  if (begin == std::string::npos) return "";
  const size_t value = begin + start.size();
  return tag.substr(value, tag.find('"', value) - value);
}

}  // namespace

std::string HtmlEscaped(const std::string& text) {
  std::string escaped;
  for (const char character : text) {
    switch (character) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += character;
    }
  }
  return escaped;
}

std::string InlineSvg(const std::filesystem::path& path, const std::string& name, const std::string& title) {
  std::ifstream file(path, std::ios::binary);
  const std::string svg{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const size_t open = svg.find("<svg");
  const size_t open_end = svg.find('>', open);
  const std::string close = "</svg>";
  const size_t end = svg.rfind(close);
  if (open == std::string::npos || end == std::string::npos)
    throw ReportError(path.string() + ": is not an SVG file");

  const std::string view_box = Attribute(svg.substr(open, open_end - open), "viewBox");
  std::string drawing = svg.substr(open_end + 1, end + close.size() - open_end - 1);
  const std::string prefix = name + "-";
  for (const char* reference : {" id='", " id=\"", "href='#", "href=\"#", "url(#"}) {
    ReplaceAll(&drawing, reference, reference + prefix);
  }
  // gnuplot spells black in several ways; on the page it is the colour of text, light or dark.
  for (const char* black :
       {"\"black\"", "'rgb(  0,   0,   0)'", "\"rgb(  0,   0,   0)\"", "\"rgb(0,0,0)\""}) {
    ReplaceAll(&drawing, black, "\"currentColor\"");
  }
  ReplaceAll(&drawing, "color=\"currentColor\"", "");
  return "<svg viewBox=\"" + view_box + "\" role=\"img\" aria-label=\"" + HtmlEscaped(title) + "\">" +
         drawing;
}

}  // namespace armada
