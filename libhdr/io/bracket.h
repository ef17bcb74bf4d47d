#pragma once
// SHOTS -> Bracket: which files, which exposures, and every check that can be made before any computing.
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"
#include "libhdr/io/exposure_list.h"

namespace hdr {

struct BracketOptions {
  std::vector<double> times;      ///< --times: seconds in the order of the files; replaces the time only
  std::optional<Path> exposures;  ///< --exposures LIST; replaces the whole exposure of the named files
  ListFormat list_format = ListFormat::kAuto;
  bool allow_equal_exposures = false;  ///< repeats of one exposure alone (merging with a known response)
  /// Things that move may fill the picture (merging without ghosts): a shot that seems to show another scene is warned
  /// of, not refused.
  bool expects_motion = false;
  /// Memory for codes, in bytes for each pixel of one shot (an 8-bit shot takes 3, a deeper one 6): the codes of all
  /// shots stay while they fit, or while they take less than 64 MB together. Otherwise only those that fit in half of
  /// it do, the others keep their samples (Photo::samples) and are decoded when more is needed (Photo::source), and the
  /// other half is left to the decoders.
  /// Absent: all stay.
  std::optional<double> code_bytes_a_pixel;
};

/// Files as named; a folder stands for its photographs, sorted by name. An empty folder, a missing file and an empty
/// list are Errors.
std::vector<Path> expand_shots(const std::vector<Path>& files_or_folder);

/// Reads the shots (in parallel) into a Bracket, sorted by exposure. Errors: no exposure time, NaN/zero/negative time,
/// too few or too many times, sizes more than 5 % apart (shots
/// trimmed by hand are cropped to what they share), mixed bit depths, all exposures equal, the same file twice, a
/// longer exposure that is darker throughout (two files named), anything read_photo throws. Every shot is decoded once
/// here, whether or not its codes stay.
Bracket read_bracket(const std::vector<Path>& files_or_folder, const BracketOptions& options = {});

}  // namespace hdr
