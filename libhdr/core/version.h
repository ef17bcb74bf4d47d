#pragma once

namespace hdr {

inline constexpr const char* kVersion = "0.1.0";

}  // namespace hdr
