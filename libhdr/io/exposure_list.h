#pragma once
// Exposures from a text file (`--exposures LIST`), in the styles that real sets come with.
#include <optional>
#include <string>
#include <vector>

#include "libhdr/core/photo.h"

namespace hdr {

/// kSeconds:  name seconds [f-number [iso [nd_stops]]]
/// kInverse:  name 1/seconds [f-number [gain_db [nd_stops]]], optionally after a count line (Debevec's
///            .hdr_image_list.txt; 3 dB double the exposure), or memorial's own list with a header line that names the
///            columns: `Filename exposure 1/shutter_speed f/stop gain(db) ND_filters`
/// kHdrgen:   path 1/seconds f-number iso 0
/// Seconds may be written 1/60; a name with spaces stands in double quotes; # begins a comment.
enum class ListFormat { kAuto, kSeconds, kInverse, kHdrgen };

struct ListedExposure {
  std::string name;  ///< as written, folders and all
  Exposure exposure;
};

/// Parses a list. With kAuto a header decides (a column called 1/shutter_speed), else `brightness` (mean code of each
/// named photograph in the order of the lines, absent when unknown): pictures that brighten while the second field
/// falls mean 1/t, hdrgen's when every fourth field is 25 or more (an ISO speed, no gain in dB). Throws Error: "LIST:7:
/// ...".
std::vector<ListedExposure> parse_exposure_list(const std::string& text, const std::string& list_name,
                                                ListFormat format = ListFormat::kAuto,
                                                const std::vector<std::optional<double>>& brightness = {});

/// "1/60 s", "0.3 s", "2 s": a shutter time as people write it.
std::string text_from_seconds(double seconds);

std::optional<ListFormat> list_format_from_name(const std::string& name);  ///< "auto", "seconds", "inverse", "hdrgen"

}  // namespace hdr
