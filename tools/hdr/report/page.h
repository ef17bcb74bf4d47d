#pragma once
// A page from its sections: one file with everything in it, and a policy that lets it fetch nothing.
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr::report {

struct Section {
  std::string id;     ///< letters, digits and dashes: what links point at
  std::string title;  ///< text
  std::string html;   ///< its content, see html.h and plot.h
};

class Page {
 public:
  /// Both are text: what was done, and one sentence of what came out.
  Page(std::string title, std::string summary) : title_(std::move(title)), summary_(std::move(summary)) {}

  /// In the order in which they are to be read. A section without content is left out.
  void add(Section section);
  /// A script at the end of the page, once however often it is asked for: one of assets.h.
  void use(const char* script);

  std::string text() const;
  /// Through the writer that loses nothing; throws Error.
  void write(const Path& path) const;

 private:
  std::string title_, summary_;
  std::vector<Section> sections_;
  std::vector<const char*> scripts_;
};

}  // namespace hdr::report
