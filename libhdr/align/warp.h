#pragma once
// A registered shot as a photograph again, for looking at and for other programs. merge/ does not need it: it samples
// each shot once through ref_from_photo.
#include "libhdr/core/photo.h"
#include "libhdr/core/vec.h"
#include "libhdr/response/response.h"

namespace hdr {

/// The shot on the reference's grid: codes are linearised, interpolated bilinearly and turned into codes again. Pixels
/// that the shot does not cover are 0.
Photo warp(const Photo& photo, const Mat3& ref_from_photo, const Response& response);

}  // namespace hdr
