#include "tools/hdr/report/page.h"

#include <fmt/format.h>

#include <algorithm>

#include "libhdr/core/version.h"
#include "libhdr/io/output_file.h"
#include "tools/hdr/report/assets.h"
#include "tools/hdr/report/html.h"

namespace hdr::report {
namespace {

/// Nothing may be loaded from anywhere: a page that only shows what it holds.
constexpr const char* kPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:";

/// An empty picture: without one, browsers ask for /favicon.ico.
constexpr const char* kNoIcon = "<link rel=\"icon\" href=\"data:,\"/>";

}  // namespace

void Page::add(Section section) {
  HDR_ASSERT(!section.id.empty() && std::all_of(section.id.begin(), section.id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  }));
  if (!section.html.empty()) sections_.push_back(std::move(section));
}

void Page::use(const char* script) {
  if (std::find(scripts_.begin(), scripts_.end(), script) == scripts_.end()) scripts_.push_back(script);
}

std::string Page::text() const {
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\"/>\n{}\n<title>{}</title>\n<style>\n{}</style>\n"
      "</head>\n<body>\n<header>\n<h1>{}</h1>\n<p>{}</p>\n<nav>",
      kPolicy, kNoIcon, escaped(title_), assets::kStyle, escaped(title_), escaped(summary_));
  for (const Section& section : sections_) {
    out += fmt::format("<a href=\"#{}\">{}</a> ", section.id, escaped(section.title));
  }
  out += "</nav>\n</header>\n<main>\n";
  for (const Section& section : sections_) {
    out += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", section.id, escaped(section.title),
                       section.html);
  }
  out += fmt::format("</main>\n<footer>hdr {}; this file holds all that it shows.</footer>\n", kVersion);
  for (const char* script : scripts_) out += fmt::format("<script>\n{}</script>\n", script);
  return out + "</body>\n</html>\n";
}

void Page::write(const Path& path) const {
  write_text(path, text());
}

}  // namespace hdr::report
