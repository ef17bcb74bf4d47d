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
    const MergeInputs inputs = prepare_merge(run, options->pipeline);
    const Merged merged = merge_to_file(run, inputs, options->output, options->write.options());
    answer_merge(run, inputs, merged);
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
