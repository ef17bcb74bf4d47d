#include "libhdr/io/output_file.h"
#include "libhdr/response/response_file.h"
#include "tools/hdr/pipeline.h"

namespace hdr::tools {

std::function<int(Run&)> declare_calibrate(CLI::App& app) {
  struct Options {
    ShotsOptions shots;
    CalibrateFlags calibrate;
    std::string align = "auto", output;
  };
  auto options = std::make_shared<Options>();
  options->shots.declare(app);
  app.add_option("-o,--output", options->output, "the response file")->required();
  options->calibrate.declare(app);
  app.add_option("--align", options->align, "register first: auto, none, mtb, ecc or features")->capture_default_str();
  return [options](Run& run) {
    const AlignMethod method = align_method(options->align);
    const Bracket bracket = read_shots(run, options->shots);
    const Alignment alignment = align_shots(run, bracket, std::nullopt, method);
    const Calibration calibration = calibrate_shots(run, bracket, alignment, options->calibrate);
    answer_calibration(run, bracket, calibration);
    write_text(options->output, text_from_response(calibration.response, options->output, calibration.rms_log_error,
                                                   calibration.deviation));
    run.say("wrote " + options->output);
    return 0;
  };
}

}  // namespace hdr::tools
