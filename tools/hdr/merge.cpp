#include <fmt/format.h>

#include "tools/hdr/pipeline.h"
#include "tools/hdr/report_merge.h"

namespace hdr::tools {
namespace {

void write_report(const ReportFlag& flag, const Run& run, const MergeInputs& inputs, const Merged& merged,
                  const MapDigest& digest) {
  report::Page page("hdr merge", fmt::format("{} shots as one radiance map of {:.1f} stops",
                                             inputs.bracket.shots.size(), merged.stops));
  add_warnings(page, run);
  add_merge(page, run, inputs, merged, digest);
  add_stages(page, run);
  page.write(flag.path);
}

}  // namespace

std::function<int(Run&)> declare_merge(CLI::App& app) {
  struct Options {
    MergePipelineOptions pipeline;
    WriteFlags write;
    ReportFlag report;
    std::string output;
  };
  auto options = std::make_shared<Options>();
  options->pipeline.declare(app);
  app.add_option("-o,--output", options->output, "the radiance map (.exr, .hdr, .tif)")->required();
  options->write.declare(app);
  options->report.declare(app);
  return [options](Run& run) {
    options->report.check();
    const MergeInputs inputs = prepare_merge(run, options->pipeline);
    std::optional<MapDigest> digest;
    if (options->report.wanted()) digest.emplace(inputs.bracket.size());
    const Merged merged =
        merge_to_file(run, inputs, options->output, options->write.options(), digest ? &*digest : nullptr);
    answer_merge(run, inputs, merged);
    run.say("wrote " + options->output);
    if (digest) run.stage("report", [&] { write_report(options->report, run, inputs, merged, *digest); });
    return 0;
  };
}

}  // namespace hdr::tools
