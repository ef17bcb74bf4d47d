// The main job in one line: bracketed photographs of a mirror ball -> a light probe.
#include <fmt/format.h>

#include "libhdr/io/output_file.h"
#include "libhdr/response/response_file.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/report_merge.h"
#include "tools/hdr/report_probe.h"
#include "tools/hdr/scale_step.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {
namespace {

void write_report(const ReportFlag& flag, const Run& run, const MergeInputs& inputs, const Merged& merged,
                  const MapDigest& digest, const RadianceMap& probe) {
  report::Page page("hdr probe", fmt::format("{} shots as a light probe of {} x {} pixels", inputs.bracket.shots.size(),
                                             probe.size().width, probe.size().height));
  add_warnings(page, run);
  add_probe(page, probe);
  add_ball(page, run.answer);
  add_merge(page, run, inputs, merged, digest, drawing_of_ball(run.answer));
  add_stages(page, run);
  page.write(flag.path);
}

}  // namespace

std::function<int(Run&)> declare_probe(CLI::App& app) {
  struct Options {
    MergePipelineOptions pipeline;
    UnwrapFlags unwrap;
    WriteFlags write;
    ReportFlag report;
    std::string output, response_output, map_output;
  };
  auto options = std::make_shared<Options>();
  options->pipeline.declare(app);
  options->pipeline.scale.makes_probe = true;
  app.add_option("-o,--output", options->output, "the light probe (.exr, .hdr, .tif)")->required();
  app.add_option("--save-response", options->response_output, "also write the response that was used");
  app.add_option("--save-map", options->map_output, "also write the merged radiance map");
  options->unwrap.declare(app);
  options->write.declare(app);
  options->report.declare(app);
  return [options](Run& run) {
    options->report.check();
    const MergeInputs inputs = prepare_merge(run, options->pipeline);
    std::optional<MapDigest> digest;
    if (options->report.wanted()) digest.emplace(inputs.bracket.size());
    Merged merged = merge_shots(run, inputs, digest ? &*digest : nullptr);
    answer_merge(run, inputs, merged);
    const std::string reference = run.answer["reference"];
    options->unwrap.correct_vignetting(merged.map);
    RadianceMap probe = unwrap_picture(run, merged.map, options->unwrap, MirrorBall::kName, reference);
    scale_by_lux(run, options->pipeline.scale, probe, merged.map);
    const Provenance provenance = provenance_of(run, inputs);
    run.stage("write", [&] {
      write_map(options->output, probe, provenance, options->write.options());
      if (!options->map_output.empty())
        write_map(options->map_output, merged.map, provenance_of_map(run, inputs), options->write.options());
      if (!options->response_output.empty()) {
        write_text(options->response_output, text_from_response(inputs.response, options->response_output,
                                                                inputs.fit ? inputs.fit->rms_log_error : 0));
      }
    });
    run.say("wrote " + options->output);
    if (digest) run.stage("report", [&] { write_report(options->report, run, inputs, merged, *digest, probe); });
    return 0;
  };
}

}  // namespace hdr::tools
