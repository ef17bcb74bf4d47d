#include "tools/hdr/report/html.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "libhdr/core/error.h"

namespace hdr::report {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the UTF-8 character that starts here [RFC 3629], or 0: overlong forms, surrogates and what lies beyond
/// U+10FFFF are none.
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const std::size_t count = lead >= 0xC2 && lead <= 0xDF   ? 2
                            : lead >= 0xE0 && lead <= 0xEF ? 3
                            : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                           : 0;
  if (count == 0) return 0;
  for (std::size_t k = 1; k < count; ++k) {
    if ((byte(k) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool outside = (lead == 0xED && byte(1) > 0x9F) || (lead == 0xF4 && byte(1) > 0x8F);
  return overlong || outside ? 0 : count;
}

bool is_control(char c) {
  const auto code = static_cast<unsigned char>(c);
  return (code < 0x20 && c != '\n' && c != '\t') || code == 0x7F;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t count = character_bytes(text);
    if (count == 0 || is_control(text[0])) {
      out += kReplacement;
      text.remove_prefix(1);
      continue;
    }
    switch (text[0]) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out.append(text.substr(0, count));
    }
    text.remove_prefix(count);
  }
  return out;
}

std::string with_code(std::string_view text) {
  std::string out;
  for (bool code = false;; code = !code) {
    const std::size_t end = text.find('`');
    // A backtick without a second is one.
    if (end == text.npos || (!code && text.find('`', end + 1) == text.npos)) return out + escaped(text);
    out += escaped(text.substr(0, end));
    out += code ? "</code>" : "<code>";
    text.remove_prefix(end + 1);
  }
}

std::string element(std::string_view name, std::string_view text, std::string_view css_class) {
  const std::string attribute = css_class.empty() ? std::string() : fmt::format(" class=\"{}\"", css_class);
  return fmt::format("<{0}{1}>{2}</{0}>", name, attribute, escaped(text));
}

std::string number(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  std::string text = fmt::format("{:.{}g}", value, digits);
  const double magnitude = std::abs(value);
  if (text.find('e') != std::string::npos && magnitude >= 1e-4 && magnitude < 1e6) {
    text = fmt::format("{:.{}f}", value, magnitude >= 1 ? 0 : digits + 3);
  }
  if (text[0] == '-') text = "−" + text.substr(1);
  return text;
}

std::string seconds_text(double seconds) {
  if (seconds > 0 && seconds < 0.3) return "1/" + number(1 / seconds, 4) + " s";
  return number(seconds, 4) + " s";
}

void Table::row(std::vector<std::string> cells) {
  HDR_ASSERT(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::html() const {
  const auto css_class = [&](std::size_t k) { return columns_[k].numeric ? "number" : ""; };
  std::string out = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (std::size_t k = 0; k < columns_.size(); ++k) out += element("th", columns_[k].title, css_class(k));
  out += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& cells : rows_) {
    out += "<tr>";
    for (std::size_t k = 0; k < cells.size(); ++k) {
      out += fmt::format("<td{}>{}</td>", columns_[k].numeric ? " class=\"number\"" : "", with_code(cells[k]));
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string Facts::html() const {
  std::string out = "<dl class=\"facts\">\n";
  for (const auto& [name, value] : facts_) {
    out += "<div>" + element("dt", name) + element("dd", value) + "</div>\n";
  }
  return out + "</dl>\n";
}

std::string list(const std::vector<std::string>& sentences, std::string_view css_class) {
  if (sentences.empty()) return {};
  std::string out = css_class.empty() ? std::string("<ul>\n") : fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& sentence : sentences) out += element("li", sentence) + "\n";
  return out + "</ul>\n";
}

std::string figure(std::string_view html, std::string_view caption, bool wide) {
  const std::string text = caption.empty() ? std::string() : element("figcaption", caption);
  return fmt::format("<figure{}>{}{}</figure>\n", wide ? " class=\"wide\"" : "", html, text);
}

}  // namespace hdr::report
