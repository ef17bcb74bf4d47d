#pragma once
// A page is checked as strictly as XML would be: tags balance, attributes are quoted, ids are there once, links lead
// somewhere, and nothing is fetched.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>
#include <vector>

namespace hdr::test {

/// What is wrong with the page, or nothing. The contents of <script> and <style> are not looked at.
inline std::string fault_of_page(const std::string& html) {
  static const std::regex tag(R"re(^<(/?)([A-Za-z][A-Za-z0-9]*)((?:\s+[a-zA-Z][a-zA-Z0-9-]*="[^"<]*")*)\s*(/?)>)re");
  static const std::regex attribute(R"re(([a-zA-Z][a-zA-Z0-9-]*)="([^"]*)")re");
  std::vector<std::string> open;
  std::set<std::string> ids, targets;
  std::size_t at = html.find('\n') + 1;  // <!DOCTYPE html>
  while (true) {
    const std::size_t next = html.find('<', at);
    const std::string text = html.substr(at, next - at);
    static const std::regex entity("&(?!(amp|lt|gt|quot|#39);)");
    if (std::regex_search(text, entity)) return "a bare & in: " + text.substr(0, 80);
    if (next == std::string::npos) break;
    const std::string piece = html.substr(next, std::min<std::size_t>(html.find('>', next) - next + 1, 1u << 16));
    const bool data_link = piece.find("href=\"data:") != std::string::npos;  // long: the expression would recurse
    std::smatch found;
    const std::string shortened = data_link ? piece.substr(0, piece.find("href=")) + ">" : piece;
    if (!std::regex_search(shortened, found, tag)) return "not a tag: " + piece.substr(0, 120);
    const std::string name = found[2], attributes = found[3];
    for (std::sregex_iterator it(attributes.begin(), attributes.end(), attribute), end; it != end; ++it) {
      const std::string key = (*it)[1], value = (*it)[2];
      if (key == "id" && !ids.insert(value).second && name != "clipPath") return "id twice: " + value;
      if (key == "href" && value[0] == '#') targets.insert(value.substr(1));
      if (key == "src" || (key == "href" && value[0] != '#' && value.rfind("data:", 0) != 0)) return "fetches " + value;
    }
    at = html.find('>', next) + 1;
    const bool closed_at_once = found[4] == "/" || piece.substr(piece.size() - 2) == "/>";
    if (found[1] == "/") {
      if (open.empty() || open.back() != name)
        return "</" + name + "> closes " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else if (!closed_at_once) {
      open.push_back(name);
      if (name == "script" || name == "style") at = html.find("</" + name, at);
      if (at == std::string::npos) return "<" + name + "> never ends";
    }
  }
  for (const std::string& target : targets) {
    if (!ids.count(target)) return "a link to nowhere: #" + target;
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

}  // namespace hdr::test
