#include <fmt/format.h>

#include "libhdr/io/output_file.h"
#include "libhdr/response/response_file.h"
#include "tools/hdr/pipeline.h"
#include "tools/hdr/report_merge.h"
#include "tools/hdr/report_response.h"

namespace hdr::tools {
namespace {

void write_report(const ReportFlag& flag, const Run& run, const Bracket& bracket, const Alignment& alignment,
                  const Calibration& calibration) {
  report::Page page("hdr calibrate", fmt::format("The response of the camera that took {} shots of {} x {} pixels",
                                                 bracket.shots.size(), bracket.size().width, bracket.size().height));
  add_warnings(page, run);
  add_response(page, bracket, alignment, calibration.response, &calibration);
  add_exposures(page, run.answer["exposures"]);
  add_alignment(page, bracket, alignment);
  add_stages(page, run);
  page.write(flag.path);
}

}  // namespace

std::function<int(Run&)> declare_calibrate(CLI::App& app) {
  struct Options {
    ShotsOptions shots;
    CalibrateFlags calibrate;
    ReportFlag report;
    std::string align = "auto", output;
  };
  auto options = std::make_shared<Options>();
  options->shots.declare(app);
  app.add_option("-o,--output", options->output, "the response file")->required();
  options->calibrate.declare(app);
  app.add_option("--align", options->align, "register first: auto, none, mtb, ecc or features")->capture_default_str();
  options->report.declare(app);
  return [options](Run& run) {
    const AlignMethod method = align_method(options->align);
    options->report.check();
    const Bracket bracket = read_shots(run, options->shots);
    const Alignment alignment = align_shots(run, bracket, std::nullopt, method);
    const Calibration calibration = calibrate_shots(run, bracket, alignment, options->calibrate);
    answer_calibration(run, bracket, calibration);
    write_text(options->output, text_from_response(calibration.response, options->output, calibration.rms_log_error,
                                                   calibration.deviation));
    run.say("wrote " + options->output);
    if (options->report.wanted()) {
      run.stage("report", [&] { write_report(options->report, run, bracket, alignment, calibration); });
    }
    return 0;
  };
}

}  // namespace hdr::tools
