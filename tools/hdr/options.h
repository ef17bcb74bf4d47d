#pragma once
// Options that several verbs share: shots, calibration, alignment, merging, unwrapping, writing.
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libhdr/align/align.h"
#include "libhdr/core/photo.h"
#include "libhdr/io/bracket.h"
#include "libhdr/io/write.h"
#include "libhdr/merge/merge.h"
#include "libhdr/probe/projection.h"
#include "libhdr/response/calibrate.h"

namespace hdr::tools {

/// "1/1000,1/250,2": numbers or fractions. Throws Error that names the option. NaN, zero and negative numbers pass: who
/// uses them knows which shot to name.
std::vector<double> times_from_text(const std::string& text, const std::string& option);
/// "2000x1500". Throws Error.
Size size_from_text(const std::string& text, const std::string& option);
/// "1,2" -> Vec2. Throws Error.
Vec2 vec2_from_text(const std::string& text, const std::string& option);
/// "1,2,3" -> as many numbers, at most `count` (0: any number of them), the rest 0. Throws Error.
std::vector<double> numbers_from_text(const std::string& text, const std::string& option, std::size_t count);
/// "1,2,3" -> Vec3. Throws Error.
Vec3 vec3_from_text(const std::string& text, const std::string& option);

struct ShotsOptions {
  std::vector<Path> files;
  std::string times, exposures, list_format = "auto";
  bool expects_motion = false;  ///< what --deghost says, where a verb has it

  void declare(CLI::App& app);
  BracketOptions bracket_options() const;
};

struct CalibrateFlags {
  std::string method = "debevec-malik";
  std::string smoothness = "auto";
  bool refine_times = false;

  void declare(CLI::App& app);
  CalibrateOptions options() const;
};

struct MergeFlags {
  std::string response = "auto";
  std::string weight = "auto";
  std::string flat;
  std::optional<double> black_level;
  bool uncertainty = false;
  bool deghost = false, drift = false;
  std::string ghost_mask;

  void declare(CLI::App& app);
  /// All but the flat field and the unit, which need files: pipeline.cpp adds them.
  MergeOptions options() const;
};

/// What turns relative radiance into cd/m^2, and several maps to one unit (tools/hdr/scale_step.h).
struct ScaleFlags {
  std::optional<double> cd_per_unit, lux;
  std::string patch, scale_like;
  bool makes_probe = false;  ///< --lux alone then means a surface under the finished probe

  void declare(CLI::App& app);
  /// Throws CLI::ValidationError when two of them contradict each other.
  void check() const;
};

/// "CX,CY,R=CD" or, with a reflectance, "CX,CY,R=18%". Throws Error.
struct Patch {
  double cx = 0, cy = 0, r = 0;       ///< a disc, continuous pixel coordinates of the map
  std::optional<double> luminance;    ///< cd/m^2
  std::optional<double> reflectance;  ///< 0..1
};
Patch patch_from_text(const std::string& text);

/// --align for verbs that merge, --method for `align` itself.
AlignMethod align_method(const std::string& name);

struct WriteFlags {
  std::string type = "half";
  std::string compression = "piz";

  void declare(CLI::App& app);
  WriteOptions options() const;
};

struct UnwrapFlags {
  std::string from, to = "latlong", ball = "auto", circle = "auto", rotate = "0,0,0";
  std::string convention = "openexr", from_convention, lens, lens_k, distortion, vignetting;
  std::optional<double> distance;
  std::optional<double> fov, vfov, camera_fov;
  std::string centre, crop, horizon, seam = "feather";
  bool level = false;
  std::string reflectance;
  int width = 2048;
  std::string implied_from;  ///< what options speak of that only a ball, or only a fisheye, has

  void declare(CLI::App& app);
  /// What a picture is whose own tag is `tag`: --from; where both are silent, what other options imply, or `otherwise`.
  std::string from_of(const std::string& tag, const std::string& otherwise = "") const;
  /// --seam, of verbs that join two fisheyes.
  void declare_seam(CLI::App& app);
  /// `name` with the field that --fov, --vfov and --centre say, where it is a bare "panorama".
  std::string with_field(const std::string& name) const;
  /// The projection to write, and its size.
  NewPicture target() const;
  /// What the options say of the picture's own lens and axes, beyond what `from` knows of it.
  void apply_to_source(Projection& source, bool with_fov) const;
  /// Divides --vignetting out of what was read.
  void correct_vignetting(RadianceMap& map) const;
  /// Whether what is written has a field that --fov could mean.
  bool target_has_field() const;
};

}  // namespace hdr::tools
