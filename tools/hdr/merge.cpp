#include "tools/hdr/pipeline.h"

namespace hdr::tools {

std::function<int(Run&)> declare_merge(CLI::App& app) {
  struct Options {
    MergePipelineOptions pipeline;
    WriteFlags write;
    std::string output;
  };
  auto options = std::make_shared<Options>();
  options->pipeline.declare(app);
  app.add_option("-o,--output", options->output, "the radiance map (.exr, .hdr, .tif)")->required();
  options->write.declare(app);
  return [options](Run& run) {
    const MergeResult result = merge_shots(run, options->pipeline);
    answer_merge(run, result);
    run.stage("write", [&] {
      write_map(options->output, result.merged.map, provenance_of(run, result), options->write.options());
    });
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
