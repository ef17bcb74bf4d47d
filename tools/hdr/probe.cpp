// The main job in one line: bracketed photographs of a mirror ball -> a light probe.
#include "libhdr/io/output_file.h"
#include "libhdr/response/response_file.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/scale_step.h"
#include "tools/hdr/unwrap_step.h"

namespace hdr::tools {

std::function<int(Run&)> declare_probe(CLI::App& app) {
  struct Options {
    MergePipelineOptions pipeline;
    UnwrapFlags unwrap;
    WriteFlags write;
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
  return [options](Run& run) {
    const MergeInputs inputs = prepare_merge(run, options->pipeline);
    Merged merged = merge_shots(run, inputs);
    answer_merge(run, inputs, merged);
    const std::string reference = run.answer["reference"];
    options->unwrap.correct_vignetting(merged.map);
    RadianceMap probe = unwrap_picture(run, merged.map, options->unwrap, MirrorBall::kName, reference);
    scale_by_lux(run, options->pipeline.scale, probe, merged.map);
    const Provenance provenance = provenance_of(run, inputs);
    run.stage("write", [&] {
      write_map(options->output, probe, provenance, options->write.options());
      if (!options->map_output.empty())
        write_map(options->map_output, merged.map, provenance, options->write.options());
      if (!options->response_output.empty()) {
        write_text(options->response_output,
                   text_from_response(inputs.response, options->response_output, inputs.rms_log_error.value_or(0)));
      }
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
