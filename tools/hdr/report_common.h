#pragma once
// --report, and the sections that every verb's report has.
#include <string>

#include "tools/hdr/report/page.h"
#include "tools/hdr/verb.h"

namespace hdr::tools {

struct ReportFlag {
  std::string path;

  void declare(CLI::App& app);
  bool wanted() const { return !path.empty(); }
  /// Before the work, not after it: throws Error when the file could not be written.
  void check() const;
};

/// The warnings of the run, if there were any.
void add_warnings(report::Page& page, const Run& run);
/// Seconds of the stages so far, and what they skipped and why. The stage that is running, the report's own, is left
/// out.
void add_stages(report::Page& page, const Run& run);

/// Plots side by side where there is room; the page gets their script.
std::string figures(report::Page& page, const std::vector<std::string>& figures);

}  // namespace hdr::tools
